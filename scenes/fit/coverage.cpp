#include <algorithm>
#include <cmath>
#include <numeric>

#include "scenes/fit/cover.h"
#include "scenes/ray_scene.h"

namespace penumbra {
namespace {

constexpr int certain_depth = 14, loose_depth = 10;

struct Cell {
  dvec3 centre;
  double half;  ///< of an edge
  int depth;
};

/// Distance from a ball's centre to the farthest corner of a cell.
double farthest_corner(const Cell& cell, const Sphere& ball) {
  const dvec3 d = glm::abs(cell.centre - dvec3(ball.centre)) + cell.half;
  return glm::length(d);
}

/// Finds the cells, 2^-depth of the solid's box, that touch the solid and that no single ball holds.
template <class Found>
class CellSearch {
 public:
  CellSearch(const RayScene& surface, const std::vector<Sphere>& balls, int deepest, Found found)
      : surface_(surface), balls_(balls), deepest_(deepest), found_(found) {}

  void run(const Bounds& box) {
    const dvec3 extent = box.extent();
    const double half = 0.5 * std::max({extent.x, extent.y, extent.z}) * (1.0 + 1e-6);
    std::vector<int> all(balls_.size());
    std::iota(all.begin(), all.end(), 0);
    visit({dvec3(box.centre()), half, 0}, all, false);
  }

 private:

  /// `near` are the balls that meet the parent cell; `inside` says that the parent lay wholly inside the solid.
  void visit(const Cell& cell, const std::vector<int>& near, bool inside_solid) {
    for (const int k : near)
      if (farthest_corner(cell, balls_[k]) <= balls_[k].radius) return;
    if (!inside_solid) {
      const vec3 centre(cell.centre);
      const double reach = cell.half * std::sqrt(3.0) * (1.0 + 1e-5);
      if (!(surface_.nearest(centre, float(reach)).distance <= reach)) {
        if (!inside(surface_, centre)) return;
        inside_solid = true;
      }
    }
    if (cell.depth == deepest_) return found_(cell);
    std::vector<int> met;
    for (const int k : near)
      if (glm::distance(cell.centre, dvec3(balls_[k].centre)) <= balls_[k].radius + cell.half * std::sqrt(3.0))
        met.push_back(k);
    for (int child = 0; child < 8; ++child) {
      const double half = 0.5 * cell.half;
      const dvec3 offset(child & 1 ? half : -half, child & 2 ? half : -half, child & 4 ? half : -half);
      visit({cell.centre + offset, half, cell.depth + 1}, met, inside_solid);
    }
  }

  const RayScene& surface_;
  const std::vector<Sphere>& balls_;
  int deepest_;
  Found found_;
};

/// Gives a cell to the ball whose volume grows least.
void grow(std::vector<Sphere>& balls, const Cell& cell) {
  Sphere* best = nullptr;
  double least = std::numeric_limits<double>::max(), radius = 0.0;
  for (Sphere& ball : balls) {
    const double needed = farthest_corner(cell, ball), own = ball.radius;
    const double cost = needed * needed * needed - own * own * own;
    if (cost < least) least = cost, best = &ball, radius = needed;
  }
  if (radius > double(best->radius)) best->radius = std::nextafter(float(radius), std::numeric_limits<float>::infinity());
}

}  // namespace

void make_covering(const Mesh& solid, SphereSet& set) {
  if (set.empty()) return;
  const RayScene surface(solid);
  CellSearch(surface, set.spheres, certain_depth, [&](const Cell& cell) { grow(set.spheres, cell); }).run(bounds(solid));
}

std::vector<vec3> loose_points(const Mesh& solid, const SphereSet& set) {
  std::vector<vec3> points;
  const RayScene surface(solid);
  const auto add = [&](const Cell& cell) {
    const vec3 centre(cell.centre);
    points.push_back(inside(surface, centre) ? centre : surface.nearest(centre, float(2.0 * cell.half)).point);
  };
  CellSearch(surface, set.spheres, loose_depth, add).run(bounds(solid));
  return points;
}

}  // namespace penumbra
