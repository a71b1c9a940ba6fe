// Light from a whole lamp without any occluder, in closed form.
//
// Irradiance of a polygon of even radiance L, with r_k the unit vectors from the receiver to its corners (Lambert 1760;
// Arvo 1995, section 2.2):
//   E = L / 2 * N . sum_k Gamma_k,   Gamma_k = theta_k * (r_k x r_k+1) / |r_k x r_k+1|
// theta_k the angle between r_k and r_k+1. What lies below the receiver's horizon is clipped away first. Reflected
// radiance is albedo / pi * E; form_factor() is E / (pi L), 1 for a lamp that fills the sky.
#pragma once

#include <cmath>
#include <vector>

#include "scenes/light.h"

namespace penumbra {

/// A lamp as a convex polygon, counter-clockwise seen from the side it shines to. A disc becomes 16 corners of equal
/// area: the second moment differs by 7e-5, the form factor by that times (radius / distance)^2.
struct LampPolygon {
  static constexpr int most = 16;
  int count = 0;
  vec3 corner[most];
  vec3 centre{0.0f}, normal{0, -1, 0};
};
LampPolygon make_polygon(const AreaLight& light);

/// theta * (a x b) / |a x b| for unit vectors.
PENUMBRA_HD inline vec3 edge_vector(vec3 a, vec3 b) {
  const vec3 cross = glm::cross(a, b);
  const float sine = glm::length(cross), cosine = glm::dot(a, b);
  return sine > 0.0f ? cross * (std::atan2(sine, cosine) / sine) : cross;
}

/// E / (pi L) of a polygon at a receiver; 0 behind the lamp and where it lies below the horizon.
PENUMBRA_HD inline float form_factor(const LampPolygon& lamp, vec3 position, vec3 normal) {
  if (!(glm::dot(lamp.normal, position - lamp.centre) > 0.0f)) return 0.0f;
  vec3 first(0.0f), last(0.0f), sum(0.0f);
  bool any = false;
  const auto visit = [&](vec3 corner) {  // the clipped polygon, corner by corner
    const float length = glm::length(corner);
    if (!(length > 0.0f)) return;
    corner /= length;
    if (any) sum += edge_vector(last, corner);
    else first = corner;
    last = corner;
    any = true;
  };
  for (int k = 0; k < lamp.count; ++k) {
    const vec3 a = lamp.corner[k] - position, b = lamp.corner[k + 1 < lamp.count ? k + 1 : 0] - position;
    const float above_a = glm::dot(normal, a), above_b = glm::dot(normal, b);
    if (above_a >= 0.0f) visit(a);
    if ((above_a < 0.0f) != (above_b < 0.0f)) visit(a + above_a / (above_a - above_b) * (b - a));
  }
  if (!any) return 0.0f;
  sum += edge_vector(last, first);
  const float factor = glm::dot(normal, sum) * float(0.5 / pi);
  return factor > 0.0f ? factor : 0.0f;
}

}  // namespace penumbra
