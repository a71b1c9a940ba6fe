#include "techniques/pcss/reuse.h"

namespace penumbra::pcss {

void link(const Reuse& how, Tile& tile) {
  for (int r = 0; r < tile.rows; ++r)
    for (int c = 0; c < tile.columns; ++c) {
      const int k = r * tile.columns + c;
      if (tile.representative[k] < 0) continue;
      tile.representative[k] = k;
      const bool left_inside = c % how.area != 0, up_inside = r % how.area != 0;
      if (how.literal && !(left_inside && up_inside)) continue;
      const RegionKey own = region_key(tile, k);
      for (const auto& [inside, other] : {std::pair(left_inside, k - 1), {up_inside, k - tile.columns}})
        if (inside && tile.representative[other] >= 0 && alike(own, region_key(tile, other), how)) {
          tile.representative[k] = tile.representative[other];
          break;
        }
    }
}

}  // namespace penumbra::pcss
