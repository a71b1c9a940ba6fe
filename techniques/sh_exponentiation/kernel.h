// The vectorised inner loops of sh-exponentiation: receivers side by side, spheres one after the other.
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <span>

#include "techniques/sh_exponentiation/hierarchy.h"
#include "techniques/technique.h"

namespace penumbra::sh_exponentiation {

/// What a sphere blocks for one receiver: a cap, and the share of it that counts (0: nothing).
struct Shadow {
  vec3 axis{0.0f, 1.0f, 0.0f};
  float cosine = 1.0f, share = 0.0f;
};

/// Self-shadow rule (Ren et al. 2006): a sphere wholly under the tangent plane, or that holds x and has its centre
/// below the plane, is dropped; one that pokes through is replaced by one of radius (R + h) / 2 that rests on the
/// plane, h = N . (P - x), fading out as h falls from 0 to -R. `replace` = false leaves the poking ones as they are. A
/// sphere around x blocks the hemisphere; on the occluder's surface it is the surface's own, and dropped.
PENUMBRA_HD inline Shadow shadow_of(const Sphere& sphere, vec3 x, vec3 normal, bool on_occluder, bool replace) {
  Shadow out;
  vec3 to = sphere.centre - x;
  float radius = sphere.radius;
  const float h = glm::dot(normal, to);
  if (!(radius > 0.0f) || h <= -radius) return out;
  if (glm::dot(to, to) <= radius * radius) {
    if (on_occluder || h < 0.0f) return out;
    return {normal, 0.0f, 1.0f};
  }
  out.share = 1.0f;
  if (replace && h < radius) {
    const float resting = 0.5f * (radius + h);
    if (h < 0.0f) out.share = (radius + h) / radius;
    to += (resting - h) * normal;
    radius = resting;
  }
  const float distance = glm::length(to), sine = radius / distance;
  out.axis = to / distance;
  out.cosine = std::sqrt(glm::max(0.0f, 1.0f - sine * sine));
  return out;
}

struct Counts {
  std::atomic<std::size_t> non_finite = 0;  ///< channel values that were not finite, and became 0
  std::atomic<std::size_t> clamped = 0;     ///< channel values below 0 or above the unshadowed light
};

/// A channel's value as it may be written: 0 if it is not finite, else within [0, unshadowed].
template <class Count>
PENUMBRA_HD float guarded(float value, float unshadowed, Count& non_finite, Count& clamped) {
  if (!(std::abs(value) <= 3.4028235e38f)) {
    ++non_finite;
    return 0.0f;
  }
  const float most = unshadowed > 0.0f ? unshadowed : 0.0f, within = value < 0.0f ? 0.0f : value < most ? value : most;
  clamped += std::abs(within - value) > 1e-5f * most;
  return within;
}

struct Job {
  int order;
  const Receivers* receivers;
  const LogTable* table;
  const LinearFit* fit;
  Method method;
  bool replace;
  std::array<float, 6> lobe;                ///< by band: what Y_lm(N) is multiplied by to make the cosine lobe about N
  std::array<std::vector<float>, 3> light;  ///< by channel: order^2 coefficients, windowed
  std::vector<float>
      by_normal;  ///< L * H(N) by texel of a cube map of normals, [texel][channel][coefficient]; or empty
  int normals;    ///< texels along an edge of that cube map
  Counts* counts;
};

/// Shades the receivers `which`, for whom `spheres` stand for the occluder.
void shade(const Job& job, std::span<const int> which, std::span<const WeightedSphere> spheres, vec3* radiance);

}  // namespace penumbra::sh_exponentiation
