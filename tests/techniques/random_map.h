// A shadow map for tests.
#pragma once

#include <random>

#include "techniques/bases/shadow_map/shadow_map.h"
#include "tests/support.h"

namespace penumbra::shadow_map {

inline float unit(std::mt19937& random) {
  return float(random() >> 8) * 0x1p-24f;
}

/// Depths in [1, 3), a third of the texels empty, in blobs so that squares are decided at every level.
inline ShadowMap random_map(int edge, unsigned seed = 1) {
  std::mt19937 random(seed);
  ShadowMap map;
  map.view.resolution = edge;
  map.view.near = 1.0f;
  map.depth.assign(map.index(0, edge), INFINITY);
  for (int blob = 0; blob < 12; ++blob) {
    const float x = unit(random) * float(edge), y = unit(random) * float(edge), r = 0.2f * unit(random) * float(edge);
    const float z = 1.0f + 2.0f * unit(random);
    for (int v = 0; v < edge; ++v)
      for (int u = 0; u < edge; ++u)
        if (std::hypot(float(u) - x, float(v) - y) < r)
          map.depth[map.index(u, v)] = std::min(map.at(u, v), z + 0.02f * unit(random));
  }
  return map;
}

}  // namespace penumbra::shadow_map
