// Vector types and constants that scalar, SIMD and CUDA code share.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>

#include "scenes/host_device.h"

namespace penumbra {

using glm::dvec3;
using glm::uvec3;
using glm::vec2;
using glm::vec3;

inline constexpr double pi = 3.14159265358979323846;

/// Relative luminance of linear Rec. 709 RGB.
PENUMBRA_HD inline float luminance(vec3 rgb) {
  return 0.2126f * rgb.x + 0.7152f * rgb.y + 0.0722f * rgb.z;
}

/// A right-handed orthonormal frame about the unit vector n (Duff et al. 2017).
PENUMBRA_HD inline void orthonormal_frame(vec3 n, vec3& tangent, vec3& bitangent) {
  const float sign = n.z < 0.0f ? -1.0f : 1.0f;
  const float a = -1.0f / (sign + n.z);
  const float b = n.x * n.y * a;
  tangent = vec3(1.0f + sign * n.x * n.x * a, sign * b, -sign * n.x);
  bitangent = vec3(b, sign + n.y * n.y * a, -n.y);
}

}  // namespace penumbra
