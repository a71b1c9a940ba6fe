#include "scenes/ray_origins.h"

#include <algorithm>
#include <cmath>

namespace penumbra {
namespace {

constexpr double rounding = 0x1p-22;  // 4 units in the last place; 2 are needed

double largest_coordinate(vec3 p) {
  return std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)});
}

}  // namespace

RayOrigins::RayOrigins(const Mesh& mesh, const RayScene& rays) : mesh_(mesh), rays_(rays) {
  std::vector<double> bounds;
  bounds.reserve(mesh.triangles.size());
  for (unsigned t = 0; t < mesh.triangles.size(); ++t) bounds.push_back(face(t).bound);
  if (bounds.empty()) return;
  std::vector<double> sorted = bounds;
  std::sort(sorted.begin(), sorted.end());
  constexpr std::size_t most = 256;
  const double usual = 32.0 * sorted[sorted.size() / 2],
               few = sorted.size() > most ? sorted[sorted.size() - most] : 0.0;
  for (unsigned t = 0; t < bounds.size(); ++t)
    if (bounds[t] > std::max(usual, few)) broad_.push_back(face(t));
    else widest_ = std::max(widest_, bounds[t]);
}

/// Heights round by the longest edge, times what the normal loses, which Embree makes from the two shorter edges.
RayOrigins::Face RayOrigins::face(unsigned triangle) const {
  constexpr double worst = 16.0;  // 8 do for slivers of 1 : 100, and thinner ones are met by few rays
  const uvec3& t = mesh_.triangles[triangle];
  const dvec3 a = mesh_.positions[t.x], b = mesh_.positions[t.y], c = mesh_.positions[t.z];
  double edge[3] = {glm::distance(a, b), glm::distance(b, c), glm::distance(c, a)};
  std::sort(edge, edge + 3);
  const dvec3 normal = glm::cross(b - a, c - a);
  const double twice_area = glm::length(normal);
  if (!(twice_area > 0.0)) return {dvec3(0.0), 0.0, 0.0, triangle};
  const double shape = std::min(worst, edge[0] * edge[1] / twice_area);
  return {normal / twice_area, glm::dot(normal / twice_area, a), rounding * shape * edge[2], triangle};
}

/// How far a point is from where no ray meets the face by rounding, m; negative if it is beyond that.
double RayOrigins::missing(const Face& face, vec3 point, double own) const {
  const double needed = own + face.bound, height = std::abs(glm::dot(face.normal, dvec3(point)) - face.offset);
  if (!(height < needed)) return -1.0;
  const uvec3& t = mesh_.triangles[face.triangle];
  const dvec3 near = nearest_point(dvec3(point), dvec3(mesh_.positions[t.x]), dvec3(mesh_.positions[t.y]),
                                   dvec3(mesh_.positions[t.z]));
  return needed - glm::distance(near, dvec3(point));
}

RayOrigins::Contact RayOrigins::contact(vec3 point) const {
  const double own = rounding * largest_coordinate(point);
  Contact contact{float(own), false};
  const auto look_at = [&](const Face& face) {
    const double more = missing(face, point, own);
    if (more < 0.0) return;
    contact.distance = std::max(contact.distance, float(more));
    contact.touches = true;
  };
  for (const Face& broad : broad_) look_at(broad);
  rays_.triangles_near(point, float(own + widest_), [&](unsigned k) { look_at(face(k)); });
  return contact;
}

}  // namespace penumbra
