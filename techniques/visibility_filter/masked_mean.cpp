#include "techniques/visibility_filter/masked_mean.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace penumbra::visibility_filter {

void find_surface(const PixelMap& map, int x, int y, int r, float epsilon, std::vector<std::uint8_t>& same) {
  const int edge = 2 * r + 1;
  same.assign(std::size_t(edge) * std::size_t(edge), 0);
  const auto at = [&](int dx, int dy) -> std::uint8_t& {
    return same[std::size_t(dy + r) * std::size_t(edge) + std::size_t(dx + r)];
  };
  const auto inside = [&](int dx, int dy) {
    return x + dx >= 0 && x + dx < map.width && y + dy >= 0 && y + dy < map.height;
  };
  const auto depth = [&](int dx, int dy) { return map.depth[map.index(x + dx, y + dy)]; };
  at(0, 0) = 1;
  for (int k = 1; k <= r; ++k)
    for (int dy = -k; dy <= k; ++dy)
      for (int dx = -k; dx <= k; dx += std::abs(dy) == k ? 1 : 2 * k) {
        const int inner_x = std::clamp(dx, 1 - k, k - 1), inner_y = std::clamp(dy, 1 - k, k - 1);
        at(dx, dy) =
            inside(dx, dy) && at(inner_x, inner_y) != 0 && joined(depth(dx, dy), depth(inner_x, inner_y), epsilon);
      }
}

Counted count_surface(const PixelMap& map, int x, int y, int r, const std::vector<std::uint8_t>& same) {
  Counted counted;
  for (int dy = -r, i = 0; dy <= r; ++dy)
    for (int dx = -r; dx <= r; ++dx, ++i) {
      if (same[std::size_t(i)] == 0) continue;
      counted.all += 1;
      counted.open += map.open[map.index(x + dx, y + dy)];
    }
  return counted;
}

float borrowed_caster(const PixelMap& map, int x, int y, int r, const std::vector<std::uint8_t>& same) {
  float caster = std::numeric_limits<float>::infinity();
  int least = std::numeric_limits<int>::max();
  for (int dy = -r, i = 0; dy <= r; ++dy)
    for (int dx = -r; dx <= r; ++dx, ++i) {
      if (same[std::size_t(i)] == 0 || dx * dx + dy * dy >= least) continue;
      const std::size_t pixel = map.index(x + dx, y + dy);
      if (map.open[pixel] != 0) continue;
      least = dx * dx + dy * dy, caster = map.caster[pixel];
    }
  return caster;
}

}  // namespace penumbra::visibility_filter
