#include "scenes/fit/difference.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "scenes/fit/solid_rows.h"
#include "scenes/fit/union_surface.h"

namespace penumbra {
namespace {

class Rows {
 public:
  Rows(const Mesh& solid, const SphereSet& set) : rays_(without_walls(solid)), box_(bounds(solid)), set_(set) {}

  /// Integral of one_row over a rectangle of (y, z) (lattice: Niederreiter & Sloan 1994).
  Difference over(const Bounds& box) const {
    constexpr int count = 75025, step = 46368, block = 25;  // neighbouring Fibonacci numbers
    std::vector<Difference> part(count / block);
    tbb::parallel_for(std::size_t(0), part.size(), [&](std::size_t b) {
      for (int i = int(b) * block; i < int(b + 1) * block; ++i) {
        const double u = (i + 0.5) / count, v = std::fmod(double(i) * step / count + 0.5 / count, 1.0);
        const Difference row =
            one_row(box.low.y + u * (double(box.high.y) - box.low.y), box.low.z + v * (double(box.high.z) - box.low.z));
        part[b].uncovered += row.uncovered, part[b].shared += row.shared;
      }
    });
    Difference sum;
    for (const Difference& p : part) sum.uncovered += p.uncovered, sum.shared += p.shared;
    const double share = (double(box.high.y) - box.low.y) * (double(box.high.z) - box.low.z) / count;
    return {share * sum.uncovered, share * sum.shared};
  }

 private:
  static double common(const Interval& in, const std::vector<Interval>& others) {
    double length = 0.0;
    for (const Interval& o : others) length += std::max(0.0, std::min(in.high, o.high) - std::max(in.low, o.low));
    return length;
  }

  /// Lengths along the row.
  Difference one_row(double y, double z) const {
    std::vector<Interval> solid;
    if (y >= box_.low.y && y <= box_.high.y && z >= box_.low.z && z <= box_.high.z)
      solid = stretches_inside(rays_, box_, vec3(0.0f, float(y), float(z)), 1e-5f * glm::length(box_.extent()));
    std::vector<Interval> chords;
    for (const Sphere& s : set_.spheres) {
      const dvec3 c = s.centre;
      const double half2 = double(s.radius) * s.radius - (y - c.y) * (y - c.y) - (z - c.z) * (z - c.z);
      if (half2 > 0.0) chords.push_back({c.x - std::sqrt(half2), c.x + std::sqrt(half2)});
    }
    std::sort(chords.begin(), chords.end(), [](const Interval& a, const Interval& b) { return a.low < b.low; });
    Difference row;
    for (const Interval& in : solid) row.uncovered += in.high - in.low;
    double reached = -std::numeric_limits<double>::infinity();
    for (const Interval& chord : chords) {
      const Interval again{chord.low, std::min(chord.high, reached)}, fresh{std::max(chord.low, reached), chord.high};
      if (again.high > again.low) row.shared += again.high - again.low - common(again, solid);
      if (fresh.high > fresh.low) row.uncovered -= common(fresh, solid);
      reached = std::max(reached, chord.high);
    }
    return {std::max(0.0, row.uncovered), std::max(0.0, row.shared)};
  }

  RayScene rays_;
  Bounds box_;
  const SphereSet& set_;
};

}  // namespace

Difference difference(const Mesh& solid, const SphereSet& set) {
  const Rows rows(solid, set);
  return {rows.over(bounds(solid)).uncovered, rows.over(bounds(set)).shared};
}

}  // namespace penumbra
