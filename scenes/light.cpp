#include "scenes/light.h"

namespace penumbra {

namespace {

/// Zero for edges that are parallel up to the rounding of their coordinates: (.1, .2, .3) and (.3, .6, .9) are.
dvec3 across(dvec3 edge_u, dvec3 edge_v) {
  const dvec3 normal = glm::cross(edge_u, edge_v);
  return glm::length(normal) > 1e-6 * glm::length(edge_u) * glm::length(edge_v) ? normal : dvec3(0.0);
}

/// In double: squares of a float of 1e-25 or 1e25 are no floats. A lamp without a side shines down.
vec3 unit_normal(dvec3 along) {
  const double length = glm::length(along);
  return length > 0.0 ? vec3(along / length) : vec3(0, -1, 0);
}

}  // namespace

double AreaLight::area() const {
  const double box = glm::length(across(dvec3(edge_u), dvec3(edge_v)));
  return shape == Shape::rectangle ? box : 0.25 * pi * box;
}

vec2 concentric_disc(float u, float v) {
  const float x = u - 0.5f, y = v - 0.5f;
  if (x == 0.0f && y == 0.0f) return {0.0f, 0.0f};
  const bool wide = std::abs(x) > std::abs(y);
  const float r = wide ? x : y;
  const float angle = wide ? float(pi / 4) * (y / x) : float(pi / 2) - float(pi / 4) * (x / y);
  return {r * std::cos(angle), r * std::sin(angle)};
}

vec3 AreaLight::point(float u, float v) const {
  const vec2 at = shape == Shape::disc ? concentric_disc(u, v) : vec2(u - 0.5f, v - 0.5f);
  return centre + at.x * edge_u + at.y * edge_v;
}

AreaLight make_rectangle(vec3 centre, vec3 edge_u, vec3 edge_v, vec3 radiance) {
  const vec3 normal = unit_normal(across(dvec3(edge_u), dvec3(edge_v)));
  return {AreaLight::Shape::rectangle, centre, edge_u, edge_v, normal, radiance};
}

AreaLight make_disc(vec3 centre, vec3 normal, float radius, vec3 radiance) {
  vec3 u, v;
  normal = unit_normal(dvec3(normal));
  orthonormal_frame(normal, u, v);
  return {AreaLight::Shape::disc, centre, 2 * radius * u, 2 * radius * v, normal, radiance};
}

}  // namespace penumbra
