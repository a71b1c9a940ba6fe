// Where the error of sh-exponentiation comes from: its approximations one by one.
#pragma once

#include <array>

#include "scenes/light.h"
#include "scenes/receivers.h"
#include "scenes/sphere_set.h"
#include "techniques/technique.h"

namespace penumbra::sh_exponentiation {

/// light:       exact visibility of the spheres at 6 x 32 x 32 texels, exact cosine, light cut to `order` bands
/// visibility:  visibility (of all spheres at once) and cosine cut to as many bands
/// exponential: the technique: visibility from the sum of logarithms
/// `bands` holds the light's coefficients by channel. Receivers on the occluder see no sphere.
std::vector<Approximation> attribute(int order, const Receivers& receivers, const SphereSet& spheres,
                                     const std::array<std::vector<float>, 3>& bands);

}  // namespace penumbra::sh_exponentiation
