// Samples of the light for the truth: those of LightSampler, but for receivers near a lamp.
//
// Points chosen evenly by area weigh g = A cos cos / (pi distance^2) (at radiance 1). Where the lamp is nearer than its
// size, a few of them carry nearly everything: the estimate is low until one of them is met, and its noise falls
// slowly. There a share s of the samples are directions of the hemisphere, chosen by cosine: those that meet the lamp
// weigh 1. The balance heuristic (Veach & Guibas 1995) gives samples of both kinds the weight
//   g / ((1 - s) + s g) < 1 / s,
// for g is the density of the one over that of the other.
#pragma once

#include "techniques/bases/light_sampling.h"

namespace penumbra {

class TruthSamples {
 public:
  /// Keeps a reference to the light.
  explicit TruthSamples(const Light& light);

  /// As LightSampler::draw, to the bit where hemisphere_share() is 0.
  void draw(vec3 position, vec3 normal, int k, std::uint64_t stream, LightSampler::Scratch& scratch) const;

  /// Environments: what LightSampler shares among the normals of a cone.
  void make_product(const Cone& normals, EnvironmentSampler::Product& product) const {
    sampler_.make_product(normals, product);
  }
  void draw_shared(const EnvironmentSampler::Product& product, int k, std::uint64_t stream,
                   std::vector<LightSample>& samples) const {
    sampler_.draw_shared(product, k, stream, samples);
  }

  /// s: 0 for environments, behind the lamp, and farther from it than the radius of a disc of its area. From the place
  /// alone, and the same in any unit.
  double hemisphere_share(vec3 position) const;

 private:
  LightSample hemisphere_sample(vec3 position, vec3 normal, vec2 at) const;
  /// Of a vector from the lamp's centre: its shares of the edges.
  glm::dvec2 in_edges(dvec3 from_centre) const;

  const AreaLight* lamp_ = nullptr;
  LightSampler sampler_;
  dvec3 across_u_{0.0}, across_v_{0.0};  ///< reciprocal to the edges within the lamp's plane
};

}  // namespace penumbra
