#include "scenes/light.h"

namespace penumbra {

double AreaLight::area() const {
  const double box = glm::length(glm::cross(dvec3(edge_u), dvec3(edge_v)));
  return shape == Shape::rectangle ? box : 0.25 * pi * box;
}

vec3 AreaLight::point(float u, float v) const {
  float x = u - 0.5f, y = v - 0.5f;
  if (shape == Shape::disc && (x != 0.0f || y != 0.0f)) {
    const bool wide = std::abs(x) > std::abs(y);
    const float r = wide ? x : y;
    const float angle = wide ? float(pi / 4) * (y / x) : float(pi / 2) - float(pi / 4) * (x / y);
    x = r * std::cos(angle);
    y = r * std::sin(angle);
  }
  return centre + x * edge_u + y * edge_v;
}

AreaLight make_rectangle(vec3 centre, vec3 edge_u, vec3 edge_v, vec3 radiance) {
  const vec3 n = glm::cross(edge_u, edge_v);
  const float length = glm::length(n);
  return {AreaLight::Shape::rectangle, centre, edge_u, edge_v, length > 0 ? n / length : vec3(0, -1, 0), radiance};
}

AreaLight make_disc(vec3 centre, vec3 normal, float radius, vec3 radiance) {
  vec3 u, v;
  normal = glm::normalize(normal);
  orthonormal_frame(normal, u, v);
  return {AreaLight::Shape::disc, centre, 2 * radius * u, 2 * radius * v, normal, radiance};
}

}  // namespace penumbra
