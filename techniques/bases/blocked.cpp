#include "techniques/bases/blocked.h"

#include <algorithm>
#include <cmath>

namespace penumbra {

void SphereLanes::assign(const SphereSet& set) {
  const std::size_t padded = (set.size() + 15) / 16 * 16;
  for (auto* lane : {&x, &y, &z, &radius}) lane->assign(padded, 0.0f);
  for (std::size_t i = 0; i < set.size(); ++i) {
    const Sphere& s = set.spheres[i];
    x[i] = s.centre.x, y[i] = s.centre.y, z[i] = s.centre.z, radius[i] = s.radius;
  }
}

void LineCones::assign(int edge, const std::vector<vec3>& directions) {
  n = edge;
  row_centre.assign(std::size_t(edge + 15) / 16 * 16, 0.0f);
  for (int row = 0; row < edge; ++row) row_centre[row] = cube_centre(row, edge);
  for (int c = 0; c < 3; ++c) {
    direction[c].clear();
    for (const vec3& w : directions) direction[c].push_back(w[c]);
  }
  axis.clear(), sine.clear(), cosine.clear();
  for (std::size_t first = 0; first < directions.size(); first += texels_per_line) {
    const auto begin = directions.begin() + std::ptrdiff_t(first), end = begin + texels_per_line;
    vec3 sum(0.0f);
    for (auto w = begin; w != end; ++w) sum += *w;
    sum = glm::normalize(sum);
    float least = 1.0f;
    for (auto w = begin; w != end; ++w) least = std::min(least, glm::dot(sum, *w));
    least = std::max(-1.0f, least - 1e-5f);
    axis.push_back(sum);
    cosine.push_back(least);
    sine.push_back(std::sqrt(1.0f - least * least));
  }
}

std::uint64_t lines_above_horizon(const LineCones& cones, vec3 normal) {
  std::uint64_t active = 0;
  for (std::size_t line = 0; line < cones.axis.size(); ++line)
    if (above_horizon(cones.cone(line), normal)) active |= std::uint64_t(1) << line;
  return active;
}

std::vector<int> tile_order(int width, int height) {
  constexpr int tile = 8;
  std::vector<int> order;
  order.reserve(std::size_t(width) * height);
  for (int y0 = 0; y0 < height; y0 += tile)
    for (int x0 = 0; x0 < width; x0 += tile)
      for (int y = y0; y < std::min(height, y0 + tile); ++y)
        for (int x = x0; x < std::min(width, x0 + tile); ++x) order.push_back(y * width + x);
  return order;
}

}  // namespace penumbra
