// shadow-map: the baseline. Share of the n x n texels about the receiver that are not nearer to the light than it
// (percentage-closer filtering, Reeves et al. 1987); n = 1 is a hard shadow (Williams 1978).
#pragma once

#include "techniques/bases/shadow_map/area_shadow.h"

namespace penumbra::hard_shadow {
using namespace shadow_map;  // NOLINT: its base

/// Finds the visibility of a tile's receivers, a lane a receiver.
void filter_tile(const ShadowMap& map, int kernel, Tile& tile);

}  // namespace penumbra::hard_shadow
