// The vectorised search for blocked texels by itself, for tests and benchmarks; techniques include blocked-inl.h.
#pragma once

#include "techniques/bases/blocked.h"

namespace penumbra {

/// Writes 6 n n / 32 words for each of the receivers [begin, end): texels that spheres block or that lie below the
/// receiver's horizon.
void find_hidden(const BlockedJob& job, int begin, int end, std::uint32_t* words);

}  // namespace penumbra
