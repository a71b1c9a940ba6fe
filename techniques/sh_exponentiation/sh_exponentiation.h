// Soft shadows from spheres by exponentiation of spherical harmonics (Ren et al. 2006).
#pragma once

namespace penumbra {

class Registry;
void register_sh_exponentiation(Registry& registry);

}  // namespace penumbra
