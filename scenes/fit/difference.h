// In what a union of spheres and a solid differ.
#pragma once

#include "scenes/sphere_set.h"

namespace penumbra {

/// Volumes, cubic metres.
struct Difference {
  double uncovered = 0.0;  ///< inside the solid, in no sphere
  double shared = 0.0;     ///< outside the solid, counted once for every sphere there but the first
};

/// Integrals over rows along x, which cross surfaces exactly; 75025 rows, in a Fibonacci lattice over the solid's box
/// and another one over the spheres': its error falls almost with the number of rows, also where faces lie along the
/// axes. `solid`: of make_solid, about one metre large. The same bits for any number of threads.
Difference difference(const Mesh& solid, const SphereSet& set);

}  // namespace penumbra
