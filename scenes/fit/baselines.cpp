#include "scenes/fit/baselines.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <tuple>

namespace penumbra {
namespace {

std::vector<vec3> farthest_points(const std::vector<vec3>& points, int count) {
  std::vector<vec3> seeds{points[0]};
  std::vector<float> distance2(points.size(), std::numeric_limits<float>::max());
  while (int(seeds.size()) < count) {
    std::size_t farthest = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const vec3 d = points[i] - seeds.back();
      distance2[i] = std::min(distance2[i], glm::dot(d, d));
      if (distance2[i] > distance2[farthest]) farthest = i;
    }
    seeds.push_back(points[farthest]);
  }
  return seeds;
}

}  // namespace

SphereSet k_means_balls(const std::vector<vec3>& points, int count) {
  std::vector<vec3> centre = farthest_points(points, count);
  std::vector<int> cluster(points.size());
  for (int iteration = 0; iteration < 40; ++iteration) {
    tbb::parallel_for(std::size_t(0), points.size(), [&](std::size_t i) {
      float nearest = std::numeric_limits<float>::max();
      for (int k = 0; k < count; ++k) {
        const vec3 d = points[i] - centre[k];
        if (const float d2 = glm::dot(d, d); d2 < nearest) nearest = d2, cluster[i] = k;
      }
    });
    std::vector<dvec3> sum(count, dvec3(0.0));
    std::vector<int> members(count);
    for (std::size_t i = 0; i < points.size(); ++i) sum[cluster[i]] += dvec3(points[i]), ++members[cluster[i]];
    for (int k = 0; k < count; ++k)
      if (members[k]) centre[k] = vec3(sum[k] / double(members[k]));
  }
  SphereSet set;
  for (const vec3& c : centre) set.spheres.push_back({c, 0.0f});
  for (std::size_t i = 0; i < points.size(); ++i) {
    Sphere& ball = set.spheres[cluster[i]];
    ball.radius = std::max(ball.radius, glm::distance(ball.centre, points[i]));
  }
  return set;
}

SphereSet grid_balls(const Bounds& box, const std::vector<vec3>& points, int count) {
  using Cell = std::tuple<int, int, int>;
  const auto occupied = [&](double edge) {
    std::set<Cell> cells;
    for (const vec3& p : points) {
      const dvec3 at = glm::floor((dvec3(p) - dvec3(box.low)) / edge);
      cells.emplace(int(at.x), int(at.y), int(at.z));
      if (int(cells.size()) > count) break;
    }
    return cells;
  };
  const dvec3 extent = box.extent();
  double coarse = 1.001 * std::max({extent.x, extent.y, extent.z}), fine = coarse / (2.0 + 2.0 * count);
  for (int i = 0; i < 40; ++i) {
    const double edge = std::sqrt(coarse * fine);
    (int(occupied(edge).size()) <= count ? coarse : fine) = edge;
  }
  SphereSet set;
  for (const auto& [x, y, z] : occupied(coarse))
    set.spheres.push_back({vec3(dvec3(box.low) + coarse * dvec3(x + 0.5, y + 0.5, z + 0.5)),
                           float(coarse * std::sqrt(0.75) * (1.0 + 1e-6))});
  return set;
}

}  // namespace penumbra
