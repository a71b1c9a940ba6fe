#include "scenes/import/polygon.h"

#include <cmath>
#include <numeric>
#include <vector>

namespace penumbra {
namespace {

using glm::dvec2;

double turn(dvec2 a, dvec2 b, dvec2 c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

/// Seen along the normal, counter-clockwise, about the first corner (so that a place far from zero costs nothing).
std::vector<dvec2> projected(std::span<const dvec3> corners, dvec3 normal) {
  const dvec3 size = glm::abs(normal);
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  const int u = (axis + 1) % 3, v = (axis + 2) % 3;
  std::vector<dvec2> points;
  points.reserve(corners.size());
  for (const dvec3& corner : corners) {
    const dvec3 p = corner - corners[0];
    points.push_back(normal[axis] > 0.0 ? dvec2(p[u], p[v]) : dvec2(p[v], p[u]));
  }
  return points;
}

bool within(dvec2 p, dvec2 a, dvec2 b, dvec2 c) {
  return turn(a, b, p) >= 0.0 && turn(b, c, p) >= 0.0 && turn(c, a, p) >= 0.0;
}

/// Whether corner i of what is left can be cut off: convex, and no other corner lies in its triangle.
bool is_ear(const std::vector<dvec2>& points, const std::vector<unsigned>& left, std::size_t i) {
  const std::size_t n = left.size();
  const dvec2 a = points[left[(i + n - 1) % n]], b = points[left[i]], c = points[left[(i + 1) % n]];
  if (turn(a, b, c) <= 0.0) return false;
  for (const unsigned k : left) {
    const dvec2 p = points[k];
    if (p == a || p == b || p == c) continue;  // polygons with holes touch themselves along their bridges
    if (within(p, a, b, c)) return false;
  }
  return true;
}

std::vector<std::array<unsigned, 3>> clip_ears(const std::vector<dvec2>& points) {
  std::vector<unsigned> left(points.size());
  std::iota(left.begin(), left.end(), 0u);
  std::vector<std::array<unsigned, 3>> triangles;
  std::size_t i = 0, tried = 0;
  while (left.size() > 3) {
    const std::size_t n = left.size();
    i %= n;
    if (!is_ear(points, left, i) && tried < n) {  // after a round without an ear it crosses itself: any will do
      ++i, ++tried;
      continue;
    }
    triangles.push_back({left[(i + n - 1) % n], left[i], left[(i + 1) % n]});
    left.erase(left.begin() + std::ptrdiff_t(i));
    tried = 0;
  }
  triangles.push_back({left[0], left[1], left[2]});
  return triangles;
}

}  // namespace

dvec3 polygon_normal(std::span<const dvec3> corners) {
  dvec3 sum(0.0);
  for (std::size_t i = 1; i + 1 < corners.size(); ++i)
    sum += glm::cross(corners[i] - corners[0], corners[i + 1] - corners[0]);
  return sum;
}

std::vector<std::array<unsigned, 3>> triangulate(std::span<const dvec3> corners) {
  const auto n = static_cast<unsigned>(corners.size());
  if (n < 3) return {};
  if (n == 3) return {{0, 1, 2}};
  const std::vector<dvec2> points = projected(corners, polygon_normal(corners));
  unsigned reflex = 0, first = 0;
  for (unsigned i = 0; i < n; ++i)
    if (turn(points[(i + n - 1) % n], points[i], points[(i + 1) % n]) < 0.0) ++reflex, first = i;
  if (n > 4 && reflex > 0) return clip_ears(points);
  std::vector<std::array<unsigned, 3>> triangles;
  for (unsigned k = 1; k + 1 < n; ++k) triangles.push_back({first, (first + k) % n, (first + k + 1) % n});
  return triangles;
}

}  // namespace penumbra
