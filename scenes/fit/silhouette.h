// Spheres whose shadows come nearest to a mesh's: the objective `shadow`.
#pragma once

#include "scenes/fit/fit.h"

namespace penumbra {

/// Moves and resizes spheres until their silhouettes match those of the solid: least squares over the pixels of
/// parallel views from directions spread over the hemisphere (the other half sees the same), by L-BFGS with the
/// analytic gradient of a union of discs with soft edges. The solid is expected to be about one unit large.
SphereSet match_silhouettes(const Mesh& solid, const SphereSet& start, const FitProgress& progress);

}  // namespace penumbra
