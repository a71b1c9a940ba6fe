#include "scenes/mirror.h"

#include <cmath>

#include "scenes/shapes.h"

namespace penumbra {
namespace {

Reflection reflected(dvec3 origin, dvec3 direction, double t, dvec3 normal) {
  if (glm::dot(normal, direction) > 0.0) normal = -normal;
  return {float(t), vec3(origin + t * direction), vec3(normal),
          vec3(glm::normalize(direction - 2.0 * glm::dot(normal, direction) * normal))};
}

std::optional<Reflection> meet(const Sphere& ball, dvec3 origin, dvec3 direction) {
  const dvec3 from = origin - dvec3(ball.centre);
  const double middle = -glm::dot(from, direction), radius = ball.radius;
  const dvec3 nearest = from + middle * direction;  // of the ray to the centre: small however far the eye is
  const double half_squared = radius * radius - glm::dot(nearest, nearest);
  if (!(half_squared > 0.0)) return {};
  const double half = std::sqrt(half_squared);
  const double t = middle - half > 0.0 ? middle - half : middle + half;
  if (!(t > 0.0)) return {};
  return reflected(origin, direction, t, glm::normalize(from + t * direction));
}

std::optional<Reflection> meet(const MirrorPlane& plane, dvec3 origin, dvec3 direction) {
  const dvec3 u = plane.edge_u, v = plane.edge_v, normal = glm::cross(u, v), to = dvec3(plane.centre) - origin;
  const double along = glm::dot(normal, direction), area_squared = glm::dot(normal, normal);
  if (along == 0.0 || area_squared == 0.0) return {};
  const double t = glm::dot(normal, to) / along;
  const dvec3 beside = t * direction - to;
  const double at_u = glm::dot(glm::cross(beside, v), normal) / area_squared;
  const double at_v = glm::dot(glm::cross(u, beside), normal) / area_squared;
  if (!(t > 0.0 && std::abs(at_u) <= 0.5 && std::abs(at_v) <= 0.5)) return {};
  return reflected(origin, direction, t, normal / std::sqrt(area_squared));
}

/// What blocks light in a mirror's place.
Mesh blocker(const Mirror& mirror) {
  constexpr int segments = 192;
  if (const auto* ball = std::get_if<Sphere>(&mirror.shape)) return make_sphere(ball->centre, ball->radius, segments);
  const auto& [centre, u, v] = std::get<MirrorPlane>(mirror.shape);
  const vec3 first = centre - 0.5f * (u + v);
  Mesh mesh;
  mesh.positions = {first, first + u, first + u + v, first + v};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  return mesh;
}

}  // namespace

std::optional<Reflection> meet(const Mirror& mirror, vec3 origin, vec3 direction) {
  return std::visit([&](const auto& shape) { return meet(shape, dvec3(origin), glm::normalize(dvec3(direction))); },
                    mirror.shape);
}

std::optional<Mirrored> nearest_mirror(const std::vector<Mirror>& mirrors, vec3 origin, vec3 direction, float before) {
  std::optional<Mirrored> nearest;
  for (std::size_t i = 0; i < mirrors.size(); ++i) {
    const auto at = meet(mirrors[i], origin, direction);
    if (!at || at->distance > before) continue;
    before = at->distance;
    nearest = {i, *at};
  }
  return nearest;
}

void add_mirrors(Mesh& mesh, const std::vector<Mirror>& mirrors) {
  for (const Mirror& mirror : mirrors)
    if (mirror.shadow) append(mesh, blocker(mirror));
}

Mesh without_mirrors(Mesh mesh, const std::vector<Mirror>& mirrors) {
  Mesh added;
  add_mirrors(added, mirrors);
  mesh.triangles.resize(mesh.triangles.size() - added.triangles.size());
  mesh.positions.resize(mesh.positions.size() - added.positions.size());
  if (!mesh.normals.empty()) mesh.normals.resize(mesh.positions.size());
  return mesh;
}

}  // namespace penumbra
