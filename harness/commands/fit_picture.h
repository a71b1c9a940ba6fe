// A picture of a mesh and the spheres that stand for it.
#pragma once

#include "scenes/image.h"
#include "scenes/sphere_set.h"

namespace penumbra {

/// Three panels of `size` x `size` pixels: the mesh, the spheres, and both, where colour shows what sticks out of the
/// mesh and grey what sticks out of the spheres. Linear values in [0, 1].
Image draw_fit(const Mesh& mesh, const SphereSet& set, int size);

}  // namespace penumbra
