// The vectorised inner loops of the wavelet techniques.
#pragma once

#include "techniques/bases/blocked.h"
#include "techniques/wavelet/sparse_product.h"

namespace penumbra::wavelet {

struct Job {
  BlockedJob blocked;
  const std::vector<Functional>* functionals;  ///< one per plan; or one of nine channels, for any normal
  const std::vector<std::uint64_t>* active;    ///< lines above the plan's horizon; null: there are no plans
  const std::vector<std::uint16_t>* plan_of;   ///< per receiver, if there are plans
};

/// Shades the receivers that are [begin, end) in the job's order, radiance without albedo times albedo.
void shade(const Job& job, int begin, int end, vec3* radiance);

}  // namespace penumbra::wavelet
