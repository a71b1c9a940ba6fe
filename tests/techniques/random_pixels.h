// Images of binary visibility that filters are tested on.
#pragma once

#include <cmath>
#include <limits>
#include <random>

#include "techniques/visibility_filter/masked_mean.h"

namespace penumbra::test {

/// Steps at random places, slopes, holes, pixels that show nothing, and patches of shadow.
inline visibility_filter::PixelMap random_map(int width, int height, unsigned seed) {
  std::mt19937 random(seed);
  const auto number = [&](int end) { return int(random() % unsigned(end)); };
  visibility_filter::PixelMap map;
  map.resize(width, height);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const auto i = std::size_t(y * width + x);
      map.depth[i] = 5.0f + 0.1f * float(x) + 0.05f * float(y);
      map.open[i] = 1;
    }
  for (int patch = 0; patch < 6 && !map.open.empty(); ++patch) {
    const int left = number(width), top = number(height), edge = 1 + number(12), kind = number(3);
    for (int y = top; y < std::min(height, top + edge); ++y)
      for (int x = left; x < std::min(width, left + edge); ++x) {
        const auto i = std::size_t(y * width + x);
        if (kind == 0) map.depth[i] -= 2.0f;
        if (kind == 1) map.open[i] = 0;
        if (kind == 2) map.depth[i] = number(3) == 0 ? std::numeric_limits<float>::quiet_NaN() : map.depth[i] + 1.0f;
      }
  }
  for (std::size_t i = 0; i < map.open.size(); ++i) {
    if (std::isnan(map.depth[i])) map.open[i] = 1;
    map.caster[i] = map.open[i] ? std::numeric_limits<float>::infinity() : 0.5f + 0.001f * float(i);
  }
  return map;
}

}  // namespace penumbra::test
