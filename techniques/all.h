// Everything that this folder holds.
#pragma once

namespace penumbra {

class Registry;

/// Adds every technique on the CPU.
void register_techniques(Registry& registry);

}  // namespace penumbra
