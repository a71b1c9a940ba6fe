// Spherical harmonic lighting with precomputed diffuse transfer (Green 2003; Sloan et al. 2002).
#pragma once

namespace penumbra {

class Registry;
void register_sh_lighting(Registry& registry);

}  // namespace penumbra
