#include "techniques/pcss/hard_shadow.h"

namespace penumbra::pcss {

std::vector<Parameter> HardShadow::parameters() {
  std::vector<Parameter> all = AreaShadow::parameters();
  all.push_back(integer_parameter("kernel", 1, 1, 255, "map texels", "edge of the filter; 1: a hard shadow"));
  return all;
}

void HardShadow::find_visibility(Tile& tile) {
  timed(filter_part, [&] {
    for (int k = 0; k < tile.size(); ++k)
      tile.visibility[k] = percentage_closer(map_, tile.x[k], tile.y[k], kernel_, tile.depth[k]);
  });
}

}  // namespace penumbra::pcss
