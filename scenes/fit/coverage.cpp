#include <algorithm>
#include <cmath>

#include "scenes/fit/cover.h"
#include "scenes/fit/union_surface.h"
#include "scenes/ray_scene.h"

namespace penumbra {
namespace {

constexpr int point_depth = 5, loose_depth = 10, certain_depth = 14;

struct Cell {
  dvec3 centre;
  double half;  ///< of an edge
  int depth;
};

/// What a search asks: how near the surface is, walls without thickness among it, and what lies inside, where they do
/// not count.
struct Surface {
  explicit Surface(const Mesh& mesh) : with_walls(mesh), solid(without_walls(mesh)) {}
  RayScene with_walls, solid;
};

/// Distance from a ball's centre to the farthest corner of a cell.
double farthest_corner(const Cell& cell, const Sphere& ball) {
  const dvec3 d = glm::abs(cell.centre - dvec3(ball.centre)) + cell.half;
  return glm::length(d);
}

/// Walks over the cells, down to 2^-deepest of the solid's box, that touch the solid and that no single ball holds.
/// Calls point(p) with a point of the solid in or near each such cell, which may let a ball grow, and leaf(cell) for
/// each of the smallest.
template <class Point, class Leaf>
class CellSearch {
 public:
  CellSearch(const Surface& surface, const std::vector<Sphere>& balls, int deepest, Point point, Leaf leaf)
      : surface_(surface), balls_(balls), deepest_(deepest), point_(point), leaf_(leaf) {}

  void run(const Bounds& box) {
    const dvec3 extent = box.extent();
    const double half = 0.5 * std::max({extent.x, extent.y, extent.z}) * (1.0 + 1e-6);
    visit({dvec3(box.centre()), half, 0}, false);
  }

 private:
  bool held(const Cell& cell) const {
    return std::any_of(balls_.begin(), balls_.end(),
                       [&](const Sphere& b) { return farthest_corner(cell, b) <= b.radius; });
  }

  /// `inside_solid` says that the parent lay wholly inside the solid.
  void visit(const Cell& cell, bool inside_solid) {
    if (held(cell)) return;
    vec3 point(cell.centre);
    if (!inside_solid) {
      const double reach = cell.half * std::sqrt(3.0) * (1.0 + 1e-5);
      const Nearest nearest = surface_.with_walls.nearest(point, float(reach));
      const bool centre_inside = inside(surface_.solid, point);
      if (!(nearest.distance <= reach)) {
        if (!centre_inside) return;
        inside_solid = true;
      }
      if (!centre_inside) point = nearest.point;
    }
    if (cell.depth >= point_depth) point_(point);
    if (cell.depth == deepest_) {
      if (!held(cell)) leaf_(cell);
      return;
    }
    for (int child = 0; child < 8; ++child) {
      const double half = 0.5 * cell.half;
      const dvec3 offset(child & 1 ? half : -half, child & 2 ? half : -half, child & 4 ? half : -half);
      visit({cell.centre + offset, half, cell.depth + 1}, inside_solid);
    }
  }

  const Surface& surface_;
  const std::vector<Sphere>& balls_;
  int deepest_;
  Point point_;
  Leaf leaf_;
};

/// Gives a cell to the ball whose volume grows least.
void grow(std::vector<Sphere>& balls, const Cell& cell) {
  Sphere* best = nullptr;
  double least = std::numeric_limits<double>::max(), radius = 0.0;
  for (Sphere& ball : balls) {
    const double needed = farthest_corner(cell, ball), own = ball.radius;
    if (needed <= own) return;
    const double cost = needed * needed * needed - own * own * own;
    if (cost < least) least = cost, best = &ball, radius = needed;
  }
  best->radius = std::nextafter(float(radius), std::numeric_limits<float>::infinity());
}

}  // namespace

void make_covering(const Mesh& solid, SphereSet& set) {
  if (set.empty()) return;
  const Surface surface(solid);
  const auto point = [&](vec3 p) { grow(set.spheres, {dvec3(p), 0.0, 0}); };
  const auto leaf = [&](const Cell& cell) { grow(set.spheres, cell); };
  CellSearch(surface, set.spheres, certain_depth, point, leaf).run(bounds(solid));
}

std::vector<vec3> loose_points(const Mesh& solid, const SphereSet& set) {
  std::vector<vec3> points;
  const Surface surface(solid);
  vec3 last(0.0f);
  const auto point = [&](vec3 p) { last = p; };
  const auto leaf = [&](const Cell&) { points.push_back(last); };  // the point of this very cell
  CellSearch(surface, set.spheres, loose_depth, point, leaf).run(bounds(solid));
  return points;
}

}  // namespace penumbra
