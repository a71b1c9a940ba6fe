// pcss-rotated: what engines ship. Fernando's steps with few samples, turned (or shifted) anew at every receiver so
// that their pattern becomes noise (bases/shadow_map/turned_samples.h).
#pragma once

#include "techniques/bases/shadow_map/area_shadow.h"
#include "techniques/bases/shadow_map/turned_samples.h"

namespace penumbra::pcss_rotated {
using namespace shadow_map;  // NOLINT: its base

/// Of both regions; see make_samples().
struct SamplePattern {
  Pattern kind = Pattern::poisson;
  std::vector<vec2> search, filter;
};

/// Write the mean depth of the search samples that block into tile.blocker, and the share of filter samples that do not
/// into tile.visibility; a lane is a receiver.
void find_blockers(const ShadowMap& map, const SamplePattern& pattern, const Turns& turns, Tile& tile);
void filter(const ShadowMap& map, const SamplePattern& pattern, const Turns& turns, float scale, Tile& tile);

}  // namespace penumbra::pcss_rotated
