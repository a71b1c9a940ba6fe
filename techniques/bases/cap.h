// The cap of directions that a sphere blocks, and the texels in it (Zhao & Che 2011, section 3.3).
//
// Sphere (P, R) seen from x: v = (P - x) / |P - x|, r = R / |P - x|, angular radius theta = asin r. A texel is blocked
// when its centre satisfies dot(w, v) >= cos theta. Scalar, SIMD and CUDA code evaluate the very same float operations
// in the same order (no fused multiply-add), so that they agree on every bit.
#pragma once

#include "scenes/sphere_set.h"
#include "techniques/bases/bit_cube.h"

namespace penumbra {

/// Unit axis and cosine of the angular radius. cosine = 2 blocks nothing (radius 0), -2 everything (x inside).
struct Cap {
  vec3 axis;
  float cosine;
};

PENUMBRA_HD inline float dot_in_order(vec3 a, vec3 b) {
  return (a.x * b.x + a.y * b.y) + a.z * b.z;
}

PENUMBRA_HD inline Cap make_cap(vec3 centre, float radius, vec3 x) {
  const vec3 to = centre - x;
  const float d2 = dot_in_order(to, to), r2 = radius * radius;
  if (!(r2 > 0.0f)) return {vec3(0.0f), 2.0f};
  if (!(r2 < d2)) return {vec3(0.0f), -2.0f};
  return {to / std::sqrt(d2), std::sqrt(1.0f - r2 / d2)};
}

PENUMBRA_HD inline bool covers(const Cap& cap, vec3 direction) {
  return dot_in_order(direction, cap.axis) >= cap.cosine;
}

/// Directions within an angle of an axis: the bounds of a line of 512 texels, with room for rounding.
struct Cone {
  vec3 axis;
  float sine, cosine;  ///< of the half angle
};

/// May any of the cone's directions lie above the horizon of the normal?
PENUMBRA_HD inline bool above_horizon(const Cone& cone, vec3 normal) {
  return cone.cosine <= 0.0f || glm::dot(cone.axis, normal) > -cone.sine - 1e-5f;
}

/// May the cap cover any of the cone's directions?
PENUMBRA_HD inline bool may_cover(const Cap& cap, const Cone& cone) {
  if (cap.cosine > 1.0f) return false;
  if (cap.cosine < 0.0f || cone.cosine <= 0.0f) return true;
  const float sine = std::sqrt(1.0f - cap.cosine * cap.cosine);
  return glm::dot(cap.axis, cone.axis) >= cap.cosine * cone.cosine - sine * cone.sine - 1e-5f;
}

/// ORs into `blocked` every texel centre that some sphere covers, seen from x. `directions` are the 6 n n unit centres.
void rasterise_spheres(const SphereSet& spheres, vec3 x, const std::vector<vec3>& directions, BitCube& blocked);

}  // namespace penumbra
