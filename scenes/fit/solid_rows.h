// A solid as parallel rows: where each row runs inside it. Volumes of a ball's share inside cost a square root and two
// look-ups a row, so a fit can ask for them hundreds of thousands of times.
#pragma once

#include <vector>

#include "scenes/ray_scene.h"
#include "scenes/sphere_set.h"

namespace penumbra {

/// A stretch of a row.
struct Interval {
  double low, high;
};

/// Where a ray along +x runs inside a solid: in order, disjoint. `row`: any point of it; only y and z count. `box`: the
/// solid's. `hair`: how far beside it looks again where it grazes an edge, metres.
std::vector<Interval> stretches_inside(const RayScene& solid, const Bounds& box, vec3 row, float hair);

class SolidRows {
 public:
  /// About `cells` cubic cells fill the solid's box; no side has more than 512 of them. Rows run along x through the
  /// cells' centres; their crossings with the surface are exact (Embree).
  SolidRows(const Mesh& solid, double cells);

  double step() const { return step_; }  ///< edge of a cell, and distance of rows, metres
  const Bounds& box() const { return box_; }
  int size(int axis) const { return size_[axis]; }
  vec3 cell_centre(int x, int y, int z) const { return vec3(low_ + step_ * dvec3(x + 0.5, y + 0.5, z + 0.5)); }

  /// Is the point inside, judged by the row nearest to it?
  bool inside(vec3 point) const;
  double volume() const { return volume_; }
  /// Volume of the ball's part inside the solid: midpoint rule over rows, cubic metres.
  double inside_volume(const dvec3& centre, double radius) const;
  double outside_volume(const dvec3& centre, double radius) const {
    return 4.0 / 3.0 * pi * radius * radius * radius - inside_volume(centre, radius);
  }

 private:
  void trace_rows(const Mesh& solid);
  std::size_t row(int y, int z) const { return std::size_t(z) * size_[1] + y; }
  /// Length inside the solid from the row's start to x.
  double length_before(std::size_t row, double x) const;

  Bounds box_;
  double step_, volume_ = 0.0;
  dvec3 low_;
  int size_[3];
  std::vector<std::vector<Interval>> inside_;  ///< by row, in order, disjoint
  std::vector<float> prefix_;                  ///< size_[0] + 1 a row: length inside before each cell's border
};

}  // namespace penumbra
