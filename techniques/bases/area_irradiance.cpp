#include "techniques/bases/area_irradiance.h"

#include <utility>

namespace penumbra {

LampOutline make_outline(const AreaLight& light) {
  LampOutline outline;
  outline.centre = light.centre;
  outline.normal = light.normal;
  if (light.shape == AreaLight::Shape::disc) {
    outline.radius = float(std::sqrt(light.area() / pi));
    return outline;
  }
  const float size =
      light.area() > 0.0 ? 1.0f : 0.0f;  // parallel edges: a point, else the sum over corners only rounds
  for (const auto& [u, v] : {std::pair(-0.5f, -0.5f), {-0.5f, 0.5f}, {0.5f, 0.5f}, {0.5f, -0.5f}})
    outline.corner[outline.count++] = light.centre + size * (u * light.edge_u + v * light.edge_v);
  // Seen along the receiver's view, the winding that makes N . sum positive is the one against the lamp's normal.
  const vec3 winding = glm::cross(outline.corner[1] - outline.corner[0], outline.corner[2] - outline.corner[1]);
  if (glm::dot(winding, light.normal) > 0.0f)
    for (int k = 0; k < outline.count / 2; ++k) std::swap(outline.corner[k], outline.corner[outline.count - 1 - k]);
  return outline;
}

}  // namespace penumbra
