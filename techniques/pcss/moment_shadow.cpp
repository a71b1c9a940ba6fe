#include "techniques/pcss/moment_shadow.h"

namespace penumbra::pcss {

std::vector<Parameter> MomentShadow::parameters() {
  std::vector<Parameter> all = AreaShadow::parameters();
  all.push_back(number_parameter("moment_bias", 1e-7, 1e-12, 0.1, "", "share of evenly spread depths in the moments"));
  all.push_back(number_parameter("filter_scale", 1.0, 0.0, 16.0, "", "c: filter width over penumbra width"));
  return all;
}

void MomentShadow::map_changed() {
  clock_.measure("moments", [&] { table_.build(map_, map_.view.farthest, parallel_); });
}

void MomentShadow::find_visibility(Tile& tile) {
  const LightView& view = map_.view;
  const auto blockers = [&](int k, float width) {
    const Moments b = biased(table_.mean(texels_of(tile.x[k], tile.y[k], width)), moment_bias_);
    return blockers_of_moments(b, table_.normalised(tile.depth[k]));
  };
  timed(blocker_part, [&] {
    for (int k = 0; k < tile.size(); ++k) {
      tile.blocker[k] = 0.0f;
      if (!(tile.depth[k] > view.near)) continue;
      const MomentBlockers found = blockers(k, view.region(view.near, tile.depth[k]));
      if (found.share > 0.0) tile.blocker[k] = std::max(view.near, table_.depth(found.mean));
    }
  });
  timed(filter_part, [&] {
    for (int k = 0; k < tile.size(); ++k) {
      const float z = tile.blocker[k], d = tile.depth[k];
      tile.visibility[k] = 1.0f;
      if (z > 0.0f && z < d) tile.visibility[k] = float(1.0 - blockers(k, view.region(z, d, filter_scale_)).share);
    }
  });
}

}  // namespace penumbra::pcss
