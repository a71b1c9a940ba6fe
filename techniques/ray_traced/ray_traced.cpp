// Monte Carlo direct lighting: B = albedo * mean of weight * V over k stratified samples of the light, chosen by
// radiance x cosine (environments) or area (lamps); see bases/light_sampling.h. The seed is a parameter: the same seed
// gives the same image.
//   scalar: one rtcOccluded1 a ray, receivers in order.
//   simd:   the same rays in packets of 16, receivers in parallel.
#include "techniques/ray_traced/ray_traced.h"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include "scenes/ray_scene.h"
#include "techniques/bases/light_sampling.h"
#include "techniques/bases/random.h"
#include "techniques/registry.h"

namespace penumbra {
namespace {

class RayTraced : public Technique {
 public:
  RayTraced(const Parameters& p, bool packets)
      : rays_per_receiver_(p.integer("rays")), seed_(std::uint64_t(p.integer("seed"))), packets_(packets) {}

  void prepare(const Scene& scene) override {
    receivers_ = &scene.receivers;
    rays_.build(scene.mesh);
    sampler_ = LightSampler(scene.light);
  }

  void update(const Frame& frame) override {
    receivers_ = &frame.receivers;
    if (frame.changed.mesh) rays_.build(frame.mesh);
    if (frame.changed.light) sampler_ = LightSampler(frame.light);
  }

  void shade(View<vec3> radiance) override {
    if (!packets_) {
      LightSampler::Scratch scratch;
      for (int i = 0; i < receivers_->size(); ++i) radiance[i] = shade_one(i, scratch);
      return;
    }
    tbb::enumerable_thread_specific<LightSampler::Scratch> scratches;
    tbb::parallel_for(tbb::blocked_range<int>(0, receivers_->size(), 64), [&](const tbb::blocked_range<int>& range) {
      LightSampler::Scratch& scratch = scratches.local();
      for (int i = range.begin(); i < range.end(); ++i) radiance[i] = shade_one(i, scratch);
    });
  }

  Footprint footprint() const override { return {0, rays_.bytes() + sampler_.bytes(), 0}; }

 private:
  vec3 shade_one(int i, LightSampler::Scratch& scratch) const {
    if (!receivers_->valid(i)) return vec3(0.0f);
    const vec3 position = receivers_->position[i], normal = receivers_->normal[i];
    sampler_.draw(position, normal, rays_per_receiver_, mix_bits(seed_ << 32 | std::uint32_t(i)), scratch);
    return receivers_->albedo[i] * estimate_radiance(rays_, position, normal, scratch.samples, packets_);
  }

  int rays_per_receiver_;
  std::uint64_t seed_;
  bool packets_;
  RayScene rays_;
  LightSampler sampler_;
  const Receivers* receivers_ = nullptr;
};

}  // namespace

void register_ray_traced(Registry& registry) {
  for (const bool packets : {false, true}) {
    Entry entry;
    entry.name = "ray-traced";
    entry.backend = packets ? "simd" : "scalar";
    entry.summary = "k shadow rays per receiver, importance-sampled by light x cosine";
    entry.citation = "Clarberg & Jarosz 2005 (sampling); Wald et al. 2014 (Embree)";
    entry.lights = {true, true};
    entry.parameters = {integer_parameter("rays", 64, 1, 65536, "rays", "shadow rays per receiver"),
                        integer_parameter("seed", 1, 0, 1 << 30, "", "same seed, same image")};
    entry.make = [packets](const Parameters& p) { return std::make_unique<RayTraced>(p, packets); };
    entry.parity = 1e-3;  // Embree's packet and single-ray traversals may round an edge differently
    registry.add(std::move(entry));
  }
}

}  // namespace penumbra
