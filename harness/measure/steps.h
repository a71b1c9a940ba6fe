// What each approximation of a technique adds to its error.
#pragma once

#include "harness/results/row.h"
#include "techniques/technique.h"

namespace penumbra {

/// Differences from `rung` over the approximations to the technique's own image. Empty if there are no approximations
/// or the rung is black.
std::vector<StepError> attribute_error(const std::vector<Approximation>& approximations, const Image& rung,
                                       const Image& own, const std::vector<bool>& valid);

}  // namespace penumbra
