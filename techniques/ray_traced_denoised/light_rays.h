// The rays of a pixel and what each brings, lamp or environment.
//
// Lamp: points of the lamp, chosen evenly by area; weight cos cos A / distance^2 of a lamp of radiance 1, one channel.
// Environment: directions chosen by radiance x cosine for a cone of normals (bases/light_sampling.h), one in each of
// equally likely parts; weight L cos / pdf, three channels. Constant factors cancel in the ratio.
//
// The shadow of an environment is as soft as its light is wide: its effective solid angle (bases/irradiance_table.h),
// taken for a disc, times a measured factor.
#pragma once

#include <algorithm>

#include "scenes/receivers.h"
#include "techniques/bases/irradiance_table.h"
#include "techniques/bases/light_sampling.h"
#include "techniques/bases/normal_table.h"
#include "techniques/ray_traced_denoised/pattern.h"

namespace penumbra::ray_traced_denoised {

/// Rays of a pixel at most: a bit each.
constexpr int most_rays = 64;

struct Ray {
  vec3 direction;  ///< lamp: all the way to it; environment: unit
  float end;       ///< where the ray ends, in lengths of `direction`
  vec3 weight;     ///< 0: no ray
};

class LightRays {
 public:
  LightRays() = default;
  LightRays(const Light& light, const Receivers& receivers, int rays, std::uint64_t seed);

  int channels() const { return lamp_ ? 1 : 3; }

  /// The rays of receiver i, which lies at `place` in the pattern.
  void make(const Receivers& receivers, int i, int place, Ray* rays) const;

  /// Full width of the penumbra, m, that a caster throws on a receiver whose ray meets it after `t` lengths of its
  /// direction: by similar triangles size t / (1 - t) for a lamp, size t for an environment.
  float penumbra(float t) const { return lamp_ ? size_ * t / std::max(1.0f - t, 1e-4f) : size_ * t; }

  /// Reflected radiance of an environment at albedo 1, without any occluder.
  vec3 unshadowed(const Receivers& receivers, int i) const;

  std::size_t bytes() const;

 private:
  void set_lamp(const AreaLight& lamp);
  void set_environment(const Environment& environment, const Receivers& receivers, std::uint64_t seed);

  bool lamp_ = false;
  int count_ = 0;
  float size_ = 0.0f;  ///< lamp: its shorter edge or its diameter, m; environment: chord of the light's angle
  std::vector<vec2> points_;
  // lamp
  vec3 normal_{0.0f};
  float area_ = 0.0f;  ///< m^2
  std::vector<vec3> on_lamp_;
  // environment
  EnvironmentSampler sampler_;
  NormalTable table_;
  IrradianceTable irradiance_;
  std::vector<std::vector<LightSample>> samples_;  ///< per cone of the table
  std::vector<vec3> exact_;                        ///< per cone of one normal
};

}  // namespace penumbra::ray_traced_denoised
