#include "techniques/bases/shadow_map/shadow_map.h"

#include <tbb/parallel_for.h>

#include <cmath>
#include <limits>

namespace penumbra::shadow_map {

void trace(const RayScene& rays, ShadowMap& map) {
  constexpr float infinity = std::numeric_limits<float>::infinity();
  const int n = map.resolution();
  map.depth.assign(map.index(0, n), infinity);
  // Blocks of 4 x 4 texels: their rays stay together longer than a row's.
  constexpr int block = 4;
  static_assert(block * block == RayPacket::size);
  const int blocks = (n + block - 1) / block;
  tbb::parallel_for(0, blocks, [&](int by) {
    for (int bx = 0; bx < blocks; ++bx) {
      RayPacket packet = {};
      std::size_t texel[RayPacket::size];
      int count = 0;
      for (int k = 0; k < RayPacket::size; ++k) {
        const int x = bx * block + k % block, y = by * block + k / block;
        if (x >= n || y >= n) continue;
        packet.set(count, map.view.ray_origin(x, y), map.view.ray_direction(x, y), infinity);
        texel[count++] = map.index(x, y);
      }
      if (!rays.meets_box(packet, count)) continue;
      float depth[RayPacket::size];
      rays.first_hits(packet, count, depth);
      for (int k = 0; k < count; ++k) map.depth[texel[k]] = depth[k];
    }
  });
}

void project(const LightView& view, const Receivers& receivers, Bias bias, Tile& tile) {
  for (int k = 0; k < tile.size(); ++k) {
    const std::size_t i = tile.first(k / tile.columns, receivers.width) + std::size_t(k % tile.columns);
    const Projected at =
        project(view, bias, receivers.position[i], receivers.normal[i], receivers.in_contact()[i] != 0);
    tile.x[k] = at.x, tile.y[k] = at.y, tile.depth[k] = at.depth, tile.rise[k] = at.rise;
  }
}

}  // namespace penumbra::shadow_map
