#include "scenes/fit/solid_rows.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "scenes/fit/union_surface.h"
#include "scenes/ray_scene.h"

namespace penumbra {
namespace {

struct Crossing {
  double x;
  bool enters;
};

/// Crossings of a ray along +x, in order.
std::vector<Crossing> crossings(const RayScene& rays, vec3 origin) {
  std::vector<Crossing> found;
  float near = 0.0f;
  for (Hit hit = rays.intersect(origin, {1, 0, 0}); hit && found.size() < 10000;
       hit = rays.intersect(origin, {1, 0, 0}, near)) {
    found.push_back({double(origin.x) + double(hit.distance), hit.normal.x < 0.0f});
    near = std::nextafter(hit.distance, std::numeric_limits<float>::infinity());
  }
  return found;
}

bool balanced(const std::vector<Crossing>& list) {
  int depth = 0;
  for (const Crossing& c : list) {
    depth += c.enters ? 1 : -1;
    if (depth < 0) return false;
  }
  return depth == 0;
}

}  // namespace

std::vector<Interval> stretches_inside(const RayScene& solid, const Bounds& box, vec3 row, float hair) {
  row.x = box.low.x - 0.01f * (box.extent().x + 1e3f * hair);
  std::vector<Crossing> found = crossings(solid, row);
  for (int attempt = 1; attempt <= 8 && !balanced(found); ++attempt)
    found = crossings(solid, row + hair * float(attempt) * vec3(0.0f, 0.83f, 0.57f));
  std::vector<Interval> inside;
  int depth = 0;
  for (std::size_t i = 0; i + 1 < found.size(); ++i) {
    depth += found[i].enters ? 1 : -1;
    if (depth <= 0) continue;
    if (!inside.empty() && inside.back().high == found[i].x) inside.back().high = found[i + 1].x;
    else inside.push_back({found[i].x, found[i + 1].x});
  }
  return inside;
}

SolidRows::SolidRows(const Mesh& solid, double cells) : box_(bounds(solid)) {
  const dvec3 extent = box_.extent();
  const double longest = std::max({extent.x, extent.y, extent.z});
  const dvec3 at_least = glm::max(extent, dvec3(longest / 512.0));
  step_ = std::max(longest / 512.0, std::cbrt(at_least.x * at_least.y * at_least.z / cells));
  for (int c = 0; c < 3; ++c) size_[c] = std::max(1, int(std::ceil(extent[c] / step_ - 1e-6)));
  low_ = dvec3(box_.centre()) - 0.5 * step_ * dvec3(size_[0], size_[1], size_[2]);
  trace_rows(solid);
}

void SolidRows::trace_rows(const Mesh& solid) {
  const RayScene rays(without_walls(solid));  // rays meet only one of two triangles that coincide
  inside_.resize(std::size_t(size_[1]) * size_[2]);
  prefix_.resize(inside_.size() * (size_[0] + 1));
  tbb::parallel_for(std::size_t(0), inside_.size(), [&](std::size_t r) {
    const int y = int(r % size_[1]), z = int(r / size_[1]);
    inside_[r] = stretches_inside(rays, box_, cell_centre(0, y, z), float(step_) * 1e-3f);
    float* before = &prefix_[r * (size_[0] + 1)];
    for (int i = 0; i <= size_[0]; ++i) {
      double length = 0.0;
      for (const Interval& in : inside_[r]) length += std::clamp(low_.x + step_ * i - in.low, 0.0, in.high - in.low);
      before[i] = float(length);
    }
  });
  for (const auto& row : inside_)
    for (const Interval& in : row) volume_ += (in.high - in.low) * step_ * step_;
}

double SolidRows::length_before(std::size_t row, double x) const {
  const float at = std::clamp(float((x - low_.x) / step_), 0.0f, float(size_[0]));
  const int cell = std::min(int(at), size_[0] - 1);
  const float* before = &prefix_[row * (size_[0] + 1) + cell];
  return before[0] + (at - float(cell)) * (before[1] - before[0]);
}

bool SolidRows::inside(vec3 point) const {
  const int y = int(std::floor((point.y - low_.y) / step_)), z = int(std::floor((point.z - low_.z) / step_));
  if (y < 0 || z < 0 || y >= size_[1] || z >= size_[2]) return false;
  const auto& intervals = inside_[row(y, z)];
  return std::any_of(intervals.begin(), intervals.end(),
                     [&](const Interval& in) { return in.low <= point.x && point.x <= in.high; });
}

double SolidRows::inside_volume(const dvec3& centre, double radius) const {
  const dvec3 c = (centre - low_) / step_ - 0.5;  // in cells, about the first cell's centre
  const double r = radius / step_;
  const int z0 = std::max(0, int(std::ceil(c.z - r))), z1 = std::min(size_[2] - 1, int(std::floor(c.z + r)));
  double sum = 0.0;
  for (int z = z0; z <= z1; ++z) {
    const double across2 = r * r - (z - c.z) * (z - c.z), across = std::sqrt(std::max(0.0, across2));
    const int y0 = std::max(0, int(std::ceil(c.y - across)));
    const int y1 = std::min(size_[1] - 1, int(std::floor(c.y + across)));
    for (int y = y0; y <= y1; ++y) {
      const std::size_t at = row(y, z);
      const double half = step_ * std::sqrt(std::max(0.0, across2 - (y - c.y) * (y - c.y)));
      sum += length_before(at, centre.x + half) - length_before(at, centre.x - half);
    }
  }
  return sum * step_ * step_;
}

}  // namespace penumbra
