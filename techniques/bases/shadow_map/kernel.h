// The vectorised steps that every shadow-map technique takes, a lane a receiver. They do the same operations in the
// same order as their scalar twins wherever a rounding could move a region's edge; none is fused.
#pragma once

#include "techniques/bases/area_irradiance.h"
#include "techniques/bases/shadow_map/shadow_map.h"

namespace penumbra::shadow_map::simd {

void find_unshadowed(const LampOutline& lamp, const Receivers& receivers, int begin, int end, float* factor);
void project(const LightView& view, const Receivers& receivers, Bias bias, Tile& tile);

}  // namespace penumbra::shadow_map::simd
