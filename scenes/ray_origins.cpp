#include "scenes/ray_origins.h"

#include <algorithm>
#include <cmath>

namespace penumbra {
namespace {

constexpr double rounding = 0x1p-20;  // 16 units in the last place

double largest_coordinate(vec3 p) {
  return std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)});
}

}  // namespace

RayOrigins::RayOrigins(const Mesh& mesh, const RayScene& rays) : mesh_(mesh), rays_(rays) {
  for (const uvec3& t : mesh.triangles) widest_ = std::max(widest_, bound(t));
}

/// Rounding of heights over a triangle: its longest edge, times what its normal loses, which Embree makes from the two
/// shorter edges.
double RayOrigins::bound(const uvec3& t) const {
  constexpr double worst = 1024.0;  // thinner slivers are hit by next to no ray
  const dvec3 a = mesh_.positions[t.x], b = mesh_.positions[t.y], c = mesh_.positions[t.z];
  double edge[3] = {glm::distance(a, b), glm::distance(b, c), glm::distance(c, a)};
  std::sort(edge, edge + 3);
  const double twice_area = glm::length(glm::cross(b - a, c - a));
  const double shape = twice_area > 0.0 ? std::min(worst, edge[0] * edge[1] / twice_area) : 0.0;
  return rounding * shape * edge[2];
}

RayOrigins::Contact RayOrigins::contact(vec3 point) const {
  const double own = rounding * largest_coordinate(point);
  double distance = own;
  bool touches = false;
  const auto look_at = [&](unsigned k) {
    const uvec3& t = mesh_.triangles[k];
    const double needed = own + bound(t);
    if (touches && needed <= distance) return;
    const dvec3 near = nearest_point(dvec3(point), dvec3(mesh_.positions[t.x]), dvec3(mesh_.positions[t.y]),
                                     dvec3(mesh_.positions[t.z]));
    if (glm::distance(near, dvec3(point)) > needed) return;
    distance = std::max(distance, needed);
    touches = true;
  };
  rays_.triangles_near(point, float(own + widest_), look_at);
  return {float(distance), touches};
}

}  // namespace penumbra
