#include "harness/measure/truth_samples.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "techniques/bases/random.h"

namespace penumbra {

TruthSamples::TruthSamples(const Light& light) : lamp_(area_light_of(light)), sampler_(light) {
  if (!lamp_ || !(lamp_->area() > 0.0)) return;
  const dvec3 u(lamp_->edge_u), v(lamp_->edge_v), n = glm::cross(u, v);
  const double square = glm::dot(n, n);
  across_u_ = glm::cross(v, n) / square, across_v_ = glm::cross(n, u) / square;
}

glm::dvec2 TruthSamples::in_edges(dvec3 from_centre) const {
  return {glm::dot(across_u_, from_centre), glm::dot(across_v_, from_centre)};
}

double TruthSamples::hemisphere_share(vec3 position) const {
  if (!lamp_) return 0.0;
  const dvec3 from = dvec3(position) - dvec3(lamp_->centre);
  if (!(glm::dot(dvec3(lamp_->normal), from) > 0.0)) return 0.0;
  // The nearest point of the lamp; of one with oblique corners, a near one.
  glm::dvec2 at = in_edges(from);
  if (lamp_->shape == AreaLight::Shape::disc) at /= std::max(1.0, 2.0 * glm::length(at));
  else at = glm::clamp(at, -0.5, 0.5);
  const dvec3 to = from - at.x * dvec3(lamp_->edge_u) - at.y * dvec3(lamp_->edge_v);
  constexpr double most = 0.75;  // the rest finds what is bright from aside
  return most * std::max(0.0, 1.0 - glm::dot(to, to) * pi / lamp_->area());
}

LightSample TruthSamples::hemisphere_sample(vec3 position, vec3 normal, vec2 at) const {
  const vec2 flat = 2.0f * concentric_disc(at.x, at.y);
  vec3 tangent, bitangent;
  orthonormal_frame(normal, tangent, bitangent);
  const float up = std::sqrt(std::max(0.0f, 1.0f - glm::dot(flat, flat)));
  const vec3 direction = glm::normalize(flat.x * tangent + flat.y * bitangent + up * normal);
  const LightSample missed = {direction, std::numeric_limits<float>::infinity(), vec3(0.0f)};
  const dvec3 from = dvec3(position) - dvec3(lamp_->centre), n(lamp_->normal);
  const double towards = -glm::dot(n, dvec3(direction));
  if (!(towards > 0.0)) return missed;
  const dvec3 to_light = glm::dot(n, from) / towards * dvec3(direction);
  const glm::dvec2 where = in_edges(from + to_light);
  const bool met = lamp_->shape == AreaLight::Shape::disc ? glm::dot(where, where) <= 0.25
                                                          : std::max(std::abs(where.x), std::abs(where.y)) <= 0.5;
  return met ? sample_point(*lamp_, vec3(to_light), normal) : missed;
}

void TruthSamples::draw(vec3 position, vec3 normal, int k, std::uint64_t stream, LightSampler::Scratch& scratch) const {
  const int turned = int(std::lround(hemisphere_share(position) * double(k))), flat = k - turned;
  if (turned == 0) return sampler_.draw(position, normal, k, stream, scratch);
  scratch.samples.resize(std::size_t(k));
  const RandomTriple flat_shift = random_triple(stream, ~0u), turned_shift = random_triple(stream, ~1u);
  const float share = float(turned) / float(k);
  for (int i = 0; i < k; ++i) {
    LightSample& sample = scratch.samples[std::size_t(i)];
    if (i < turned) {
      sample = hemisphere_sample(position, normal, shifted_hammersley(i, turned, turned_shift));
    } else {
      const vec2 at = shifted_hammersley(i - turned, flat, flat_shift);
      sample = sample_point(*lamp_, lamp_->point(at.x, at.y) - position, normal);
    }
    sample.weight *= lamp_->radiance / ((1.0f - share) + share * sample.weight.x);
  }
}

}  // namespace penumbra
