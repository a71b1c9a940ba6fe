#include "techniques/ray_traced_denoised/light_rays.h"

#include <cmath>

#include "techniques/bases/for_ranges.h"
#include "techniques/bases/random.h"

namespace penumbra::ray_traced_denoised {
namespace {

/// Of a receiver that touches the lamp; a sum over rays and pixels stays finite.
constexpr float most_weight = 1e30f;

/// An environment has no rim: beside what is brightest lies more. How many times as wide as a disc of its effective
/// solid angle it counts, as measured (docs/visibility-filter.md).
constexpr float environment_scale = 4.0f;

}  // namespace

LightRays::LightRays(const Light& light, const Receivers& receivers, int rays, std::uint64_t seed)
    : lamp_(area_light_of(light) != nullptr), count_(rays), points_(pattern_points(rays, seed)) {
  if (lamp_) set_lamp(*area_light_of(light));
  else set_environment(*environment_of(light), receivers, seed);
}

void LightRays::set_lamp(const AreaLight& lamp) {
  size_ = std::min(glm::length(lamp.edge_u), glm::length(lamp.edge_v));
  normal_ = lamp.normal, area_ = float(lamp.area());
  on_lamp_.reserve(points_.size());
  for (const vec2 at : points_) on_lamp_.push_back(lamp.point(at.x, at.y));
}

void LightRays::set_environment(const Environment& environment, const Receivers& receivers, std::uint64_t seed) {
  sampler_ = EnvironmentSampler(environment);
  irradiance_ = IrradianceTable(environment, receivers.normal);
  size_ = environment_scale * 2.0f * float(std::sqrt(irradiance_.effective_solid_angle() / pi));
  table_ = NormalTable::of(receivers.normal);
  samples_.resize(table_.cones.size());
  exact_.resize(table_.cones.size());
  for_ranges(int(table_.cones.size()), 1, [&](int begin, int end) {
    EnvironmentSampler::Product product;
    for (int k = begin; k < end; ++k) {
      const Cone& cone = table_.cones[std::size_t(k)];
      if (one_normal(cone)) exact_[std::size_t(k)] = sampler_.unshadowed(cone.axis);
      sampler_.make_product(cone, product);
      std::vector<LightSample>& samples = samples_[std::size_t(k)];
      samples.reserve(points_.size());
      for (std::size_t i = 0; i < points_.size(); ++i) {
        const RandomTriple within = random_triple(mix_bits(seed + 1), std::uint32_t(i));
        samples.push_back(sampler_.shared_sample(product, double(points_[i].x), within.y, within.z));
      }
    }
  });
}

void LightRays::make(const Receivers& receivers, int i, int place, Ray* rays) const {
  const vec3 n = receivers.normal[i];
  const auto first = std::size_t(place) * std::size_t(count_);
  if (!lamp_) {
    const LightSample* samples = samples_[table_.index[i]].data() + first;
    for (int j = 0; j < count_; ++j) {
      const float cosine = std::max(0.0f, glm::dot(n, samples[j].direction));
      rays[j] = {samples[j].direction, samples[j].distance, cosine * samples[j].weight};
    }
    return;
  }
  const vec3 p = receivers.position[i];
  for (int j = 0; j < count_; ++j) {
    const vec3 to = on_lamp_[first + std::size_t(j)] - p;
    const float d2 = glm::dot(to, to), above = glm::dot(n, to), before = -glm::dot(normal_, to);
    const float weight = above > 0.0f && before > 0.0f ? area_ / d2 * (above / d2) * before : 0.0f;
    rays[j] = {to, 1.0f - 1e-4f, vec3(weight < most_weight ? weight : most_weight)};
  }
}

vec3 LightRays::unshadowed(const Receivers& receivers, int i) const {
  const std::size_t group = table_.index[i];
  return one_normal(table_.cones[group]) ? exact_[group] : irradiance_.at(receivers.normal[i]);
}

std::size_t LightRays::bytes() const {
  std::size_t all = sampler_.bytes() + irradiance_.bytes() + on_lamp_.size() * sizeof(vec3) +
                    points_.size() * sizeof(vec2) + table_.index.size() * sizeof(std::uint16_t);
  for (const auto& samples : samples_) all += samples.size() * sizeof(LightSample);
  return all;
}

}  // namespace penumbra::ray_traced_denoised
