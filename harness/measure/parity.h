// A backend compared with its scalar twin.
#pragma once

#include "techniques/registry.h"

namespace penumbra {

/// RMSE between a variant and its scalar twin over the RMS of the twin's image, on at most 32 x 32 of the scene's
/// receivers; 0 for scalar itself or if there is no twin. An image darker than a hundredth of what would arrive
/// (light_scale()) is compared as if it were that bright: where light cancels, only round-off is left to differ.
double parity_with_scalar(const Registry& registry, const Entry& entry, const Parameters& parameters,
                          const Scene& scene);

/// Every stride-th receiver of a scene, so that at most `edge` x `edge` (or edge^2 in a row) are left.
Scene thinned(const Scene& scene, int edge);

}  // namespace penumbra
