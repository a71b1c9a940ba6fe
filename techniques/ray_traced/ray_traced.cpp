// Monte Carlo direct lighting: B = albedo * mean of weight * V over k stratified samples of the light, chosen by
// radiance x cosine (environments) or area (lamps); see bases/light_sampling.h. The seed is a parameter: the same seed
// gives the same image.
//
// Choosing a direction costs more than tracing it, so receivers that share a normal share 64 sets of directions, made
// in update(); an 8 x 8 pattern of receivers uses each once (interleaved sampling, Keller & Heidrich 2001). These sets
// can afford the ratio estimator (Heitz et al. 2018): unshadowed light exactly, its visible share by sampling.
//   scalar: one rtcOccluded1 a ray, receivers in order.
//   simd:   the same rays; ray j of 4 x 4 neighbours in one packet of 16, tiles in parallel.
#include "techniques/ray_traced/ray_traced.h"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include "scenes/error.h"
#include "techniques/bases/distinct_normals.h"
#include "techniques/bases/random.h"
#include "techniques/bases/ray_packets.h"
#include "techniques/registry.h"

namespace penumbra {
namespace {

using SampleSet = std::vector<LightSample>;

class RayTraced : public Technique {
 public:
  explicit RayTraced(const Parameters& p)
      : count_(p.integer("rays")),
        seed_(std::uint64_t(p.integer("seed"))),
        ratio_(p.text("estimator") == "ratio"),
        spheres_(p.text("occluder") == "spheres") {}

  void prepare(const Scene& scene) override {
    if (spheres_ && scene.spheres.empty()) throw Unsupported("occluder = spheres: the scene has no spheres");
    const auto& on = scene.receivers.on_occluder;
    if (spheres_ && std::any_of(on.begin(), on.end(), [](std::uint8_t lies) { return lies != 0; }))
      throw Unsupported("occluder = spheres: receivers lie on the mesh, inside its spheres");
    build(scene.mesh, scene.spheres);
    set_light(scene.light, scene.receivers);
  }

  void update(const Frame& frame) override {
    receivers_ = &frame.receivers;
    if (spheres_ ? frame.changed.spheres : frame.changed.mesh) build(frame.mesh, frame.spheres);
    if (frame.changed.light || frame.changed.receivers) set_light(frame.light, frame.receivers);
  }

  void shade(View<vec3> radiance) override {
    LightSampler::Scratch scratch;
    for (int i = 0; i < receivers_->size(); ++i) {
      radiance[i] = vec3(0.0f);
      if (!receivers_->valid(i)) continue;
      const SampleSet& samples = samples_of(i, scratch);
      radiance[i] = receivers_->albedo[i] * estimate_radiance(rays_, receivers_->ray_origin(i), samples);
    }
  }

  Footprint footprint() const override {
    return {0, rays_.bytes() + sampler_.bytes(), pools_.size() * pattern * pattern * count_ * sizeof(LightSample)};
  }

 protected:
  static constexpr int pattern = 8;

  /// The receiver's samples: shared ones, or drawn into scratch.
  const SampleSet& samples_of(int i, LightSampler::Scratch& scratch) const {
    if (normals_.few()) {
      const int x = i % receivers_->width % pattern, y = i / receivers_->width % pattern;
      return pools_[normals_.index[i]][y * pattern + x];
    }
    sampler_.draw(receivers_->position[i], receivers_->normal[i], count_, stream(std::uint32_t(i)), scratch);
    return scratch.samples;
  }

  int count_;
  RayScene rays_;
  const Receivers* receivers_ = nullptr;

 private:
  void build(const Mesh& mesh, const SphereSet& spheres) {
    if (spheres_) rays_.build(spheres);
    else rays_.build(mesh);
  }

  std::uint64_t stream(std::uint32_t index) const { return mix_bits(seed_ << 32 | index); }

  void set_light(const Light& light, const Receivers& receivers) {
    receivers_ = &receivers;
    sampler_ = LightSampler(light);
    // The samples of an area light depend on the position too.
    normals_ = environment_of(light) ? DistinctNormals::of(receivers.normal) : DistinctNormals{};
    pools_.assign(normals_.normals.size(), std::vector<SampleSet>(pattern * pattern));
    for (std::size_t k = 0; k < pools_.size(); ++k) {
      const vec3 normal = normals_.normals[k], unshadowed = ratio_ ? sampler_.unshadowed(normal) : vec3(0.0f);
      tbb::parallel_for(0, pattern * pattern, [&](int set) {
        LightSampler::Scratch scratch;
        sampler_.draw(vec3(0.0f), normal, count_, stream(std::uint32_t(set)), scratch);
        if (ratio_) LightSampler::normalise(unshadowed, scratch.samples);
        pools_[k][set] = std::move(scratch.samples);
      });
    }
  }

  std::uint64_t seed_;
  bool ratio_, spheres_;
  LightSampler sampler_;
  DistinctNormals normals_;
  std::vector<std::vector<SampleSet>> pools_;  ///< per distinct normal
};

class RayTracedPackets final : public RayTraced {
 public:
  using RayTraced::RayTraced;

  void shade(View<vec3> radiance) override {
    struct Scratch {
      std::array<LightSampler::Scratch, RayPacket::size> samples;
    };
    tbb::enumerable_thread_specific<Scratch> scratches;
    const int columns = (receivers_->width + 3) / 4, rows = (receivers_->height + 3) / 4;
    tbb::parallel_for(tbb::blocked_range<int>(0, columns * rows, 4), [&](const tbb::blocked_range<int>& tiles) {
      auto& scratch = scratches.local().samples;
      for (int tile = tiles.begin(); tile < tiles.end(); ++tile)
        shade_tile(tile % columns * 4, tile / columns * 4, scratch.data(), radiance);
    });
  }

 private:
  void shade_tile(int x0, int y0, LightSampler::Scratch* scratch, View<vec3> radiance) const {
    int which[RayPacket::size], count = 0;
    const LightSample* samples[RayPacket::size];
    vec3 estimate[RayPacket::size];
    for (int y = y0; y < std::min(y0 + 4, receivers_->height); ++y)
      for (int x = x0; x < std::min(x0 + 4, receivers_->width); ++x) {
        const int i = y * receivers_->width + x;
        radiance[i] = vec3(0.0f);
        if (!receivers_->valid(i)) continue;
        samples[count] = samples_of(i, scratch[count]).data();
        which[count++] = i;
      }
    const auto span = std::size_t(count);
    estimate_packet(rays_, *receivers_, {which, span}, {samples, span}, count_, estimate);
    for (int k = 0; k < count; ++k) radiance[which[k]] = receivers_->albedo[which[k]] * estimate[k];
  }
};

}  // namespace

void register_ray_traced(Registry& registry) {
  for (const bool packets : {false, true}) {
    Entry entry;
    entry.name = "ray-traced";
    entry.backend = packets ? "simd" : "scalar";
    entry.summary = "k shadow rays per receiver, importance-sampled by light x cosine";
    entry.citation = "Clarberg & Jarosz 2005; Keller & Heidrich 2001; Wald et al. 2014 (Embree)";
    entry.lights = {true, true};
    entry.reads_spheres = [](const Parameters& p) { return p.text("occluder") == "spheres"; };
    entry.parameters = {
        integer_parameter("rays", 64, 1, 65536, "rays", "shadow rays per receiver"),
        integer_parameter("seed", 1, 0, 1 << 30, "", "same seed, same image"),
        choice_parameter("estimator", {"ratio", "plain"},
                         "ratio: exact unshadowed light x sampled visible share, where normals are shared"),
        choice_parameter("occluder", {"mesh", "spheres"},
                         "what the rays meet; spheres show the error of the fit alone")};
    entry.knobs = {
        {"rays", {1, 2, 3, 4, 6, 8, 12, 16, 24, 32, 48, 64, 96, 128, 192, 256, 512, 1024, 2048, 4096}, true}};
    entry.errs_by = "noise";
    if (packets) entry.make = [](const Parameters& p) { return std::make_unique<RayTracedPackets>(p); };
    else entry.make = [](const Parameters& p) { return std::make_unique<RayTraced>(p); };
    entry.parity = 1e-3;  // Embree's packet and single-ray traversals may round an edge differently
    registry.add(std::move(entry));
  }
}

}  // namespace penumbra
