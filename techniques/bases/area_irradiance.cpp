#include "techniques/bases/area_irradiance.h"

namespace penumbra {

LampPolygon make_polygon(const AreaLight& light) {
  LampPolygon polygon;
  polygon.centre = light.centre;
  polygon.normal = light.normal;
  const float size =
      light.area() > 0.0 ? 1.0f : 0.0f;  // parallel edges: a point, else the sum over corners only rounds
  const auto add = [&](double u, double v) {
    polygon.corner[polygon.count++] = light.centre + size * (float(u) * light.edge_u + float(v) * light.edge_v);
  };
  if (light.shape == AreaLight::Shape::rectangle) {
    for (const auto& [u, v] : {std::pair(-0.5, -0.5), {-0.5, 0.5}, {0.5, 0.5}, {0.5, -0.5}}) add(u, v);
  } else {
    const double step = 2.0 * pi / LampPolygon::most;
    const double radius = 0.5 * std::sqrt(pi / (0.5 * LampPolygon::most * std::sin(step)));  // area of the disc
    for (int k = 0; k < LampPolygon::most; ++k) add(radius * std::cos(-k * step), radius * std::sin(-k * step));
  }
  // Seen along the receiver's view, the winding that makes N . sum positive is the one against the lamp's normal.
  const vec3 winding = glm::cross(polygon.corner[1] - polygon.corner[0], polygon.corner[2] - polygon.corner[1]);
  if (glm::dot(winding, light.normal) > 0.0f)
    for (int k = 0; k < polygon.count / 2; ++k) std::swap(polygon.corner[k], polygon.corner[polygon.count - 1 - k]);
  return polygon;
}

}  // namespace penumbra
