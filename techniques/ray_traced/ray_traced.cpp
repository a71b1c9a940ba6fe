// Monte Carlo direct lighting: B = albedo * mean of weight * V over k stratified samples of the light, chosen by
// radiance x cosine (environments) or area (lamps); see bases/light_sampling.h. The seed is a parameter: the same seed
// gives the same image.
//
// Choosing a direction costs more than tracing it, so receivers share sets of directions, made in update()
// (interleaved sampling, Keller & Heidrich 2001):
//   those of one normal    64 sets, an 8 x 8 pattern of receivers uses each once. They can afford the ratio estimator
//                          (Heitz et al. 2018): unshadowed light exactly, its visible share by sampling.
//   those of a cone        16 sets in a 4 x 4 pattern for all normals in a cell of bases/normal_table.h; each receiver
//                          weighs them by its own cosine, without bias. Were all sets more than 64 MiB (some 400 rays
//                          for the normals of a bunny), each receiver would draw its own from its cell's distribution.
// Under a lamp each receiver draws its own: they depend on its place too.
//   scalar: one rtcOccluded1 a ray, receivers in order.
//   simd:   the same rays; ray j of 4 x 4 neighbours in one packet of 16, tiles in parallel.
#include <tbb/enumerable_thread_specific.h>

#include "scenes/error.h"
#include "techniques/bases/for_ranges.h"
#include "techniques/bases/normal_table.h"
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
        spheres_(p.text("occluder") == "spheres"),
        refit_(p.text("tree") == "refit") {}

  void prepare(const Scene& scene, const Light& light) override {
    if (spheres_ && scene.spheres.empty()) throw Unsupported("occluder = spheres: the scene has no spheres");
    const auto& on = scene.receivers.on_occluder;
    if (spheres_ && std::any_of(on.begin(), on.end(), [](std::uint8_t lies) { return lies != 0; }))
      throw Unsupported("occluder = spheres: receivers lie on the mesh, inside its spheres");
    build(scene.mesh, scene.spheres);
    set_light(light, scene.receivers);
  }

  void update(const Frame& frame) override {
    receivers_ = &frame.receivers;
    if (spheres_ ? frame.changed.spheres : frame.changed.mesh) move(frame.mesh, frame.spheres);
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
    std::size_t sets = table_.index.size() * sizeof(std::uint16_t);
    for (const Group& group : groups_) sets += group.sets.size() * count_ * sizeof(LightSample) + group.product.bytes();
    return {0, rays_.bytes() + sampler_.bytes(), sets};
  }

 protected:
  static constexpr int pattern = 8, cone_pattern = 4;
  static constexpr std::size_t most_bytes = 64 << 20;  // of the sets of all cones

  /// The receiver's samples: shared ones, or made in scratch.
  const SampleSet& samples_of(int i, LightSampler::Scratch& scratch) const {
    if (groups_.empty()) {
      sampler_.draw(receivers_->position[i], receivers_->normal[i], count_, stream(std::uint32_t(i)), scratch);
      return scratch.samples;
    }
    const Group& group = groups_[table_.index[i]];
    const int x = i % receivers_->width, y = i / receivers_->width;
    if (group.single) return group.sets[y % pattern * pattern + x % pattern];
    if (group.sets.empty()) sampler_.draw_shared(group.product, count_, stream(std::uint32_t(i)), scratch.shared);
    const SampleSet& shared =
        group.sets.empty() ? scratch.shared : group.sets[y % cone_pattern * cone_pattern + x % cone_pattern];
    LightSampler::face(shared, receivers_->normal[i], scratch.samples);
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

  void move(const Mesh& mesh, const SphereSet& spheres) {
    if (refit_ && !spheres_) rays_.move(mesh);
    else build(mesh, spheres);
  }

  std::uint64_t stream(std::uint32_t index) const { return mix_bits(seed_ << 32 | index); }

  /// Receivers whose normals lie in one cone of the table.
  struct Group {
    bool single;
    std::vector<SampleSet> sets;
    EnvironmentSampler::Product product;  ///< of a cone
  };

  void set_light(const Light& light, const Receivers& receivers) {
    receivers_ = &receivers;
    sampler_ = LightSampler(light);
    table_ = environment_of(light) ? NormalTable::of(receivers.normal) : NormalTable{};
    const auto single = std::size_t(std::count_if(table_.cones.begin(), table_.cones.end(), one_normal));
    const std::size_t cones = table_.cones.size() - single, sets = cone_pattern * cone_pattern;
    const bool keep = cones * sets * std::size_t(count_) * sizeof(LightSample) <= most_bytes;
    groups_.assign(table_.cones.size(), {});
    for_ranges(int(groups_.size()), 1, [&](int begin, int end) {
      for (int k = begin; k < end; ++k) groups_[k] = make_group(table_.cones[k], keep);
    });
  }

  Group make_group(const Cone& cone, bool keep) const {
    Group group{one_normal(cone), {}, {}};
    if (group.single) {
      make_sets(cone.axis, group.sets);
      return group;
    }
    sampler_.make_product(cone, group.product);
    if (!keep) return group;
    group.sets.resize(cone_pattern * cone_pattern);
    for (std::size_t set = 0; set < group.sets.size(); ++set)
      sampler_.draw_shared(group.product, count_, stream(std::uint32_t(set)), group.sets[set]);
    return group;
  }

  /// The sets of one normal.
  void make_sets(vec3 normal, std::vector<SampleSet>& sets) const {
    const vec3 unshadowed = ratio_ ? sampler_.unshadowed(normal) : vec3(0.0f);
    sets.resize(pattern * pattern);
    for_ranges(pattern * pattern, 1, [&](int begin, int end) {
      LightSampler::Scratch scratch;
      for (int set = begin; set < end; ++set) {
        sampler_.draw(vec3(0.0f), normal, count_, stream(std::uint32_t(set)), scratch);
        if (ratio_) LightSampler::normalise(unshadowed, scratch.samples);
        sets[set] = scratch.samples;
      }
    });
  }

  std::uint64_t seed_;
  bool ratio_, spheres_, refit_;
  LightSampler sampler_;
  NormalTable table_;
  std::vector<Group> groups_;  ///< per cone of the table; none under a lamp
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
    for_ranges(columns * rows, 4, [&](int begin, int end) {
      auto& scratch = scratches.local().samples;
      for (int tile = begin; tile < end; ++tile)
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
  Entry entry;
  entry.name = "ray-traced";
  entry.summary = "k shadow rays per receiver, importance-sampled by light x cosine";
  entry.citation = "Clarberg & Jarosz 2005; Keller & Heidrich 2001; Wald et al. 2014 (Embree)";
  entry.lights = {true, true};
  entry.reads_spheres = [](const Parameters& p) { return p.text("occluder") == "spheres"; };
  entry.parameters = {
      integer_parameter("rays", 64, 1, 65536, "rays", "shadow rays per receiver"),
      integer_parameter("seed", 1, 0, 1 << 30, "", "seed of the samples: same seed, same image"),
      choice_parameter("estimator", {"ratio", "plain"},
                       "ratio: exact unshadowed light x sampled visible share, where many receivers share a normal"),
      choice_parameter("occluder", {"mesh", "spheres"}, "what the rays meet; spheres show the error of the fit alone"),
      choice_parameter(
          "tree", {"refit", "rebuild"},
          "of a mesh that moves: keep the tree and refit its boxes while they stay small, or build it anew "
          "in every frame")};
  entry.knobs = {{"rays", {1, 2, 3, 4, 6, 8, 12, 16, 24, 32, 48, 64, 96, 128, 192, 256, 512, 1024, 2048, 4096}, true}};
  entry.errs_by = "noise";
  entry.parity = 1e-3;  // Embree's packet and single-ray traversals may round an edge differently
  add_pair<RayTraced, RayTracedPackets>(registry, std::move(entry));
}

}  // namespace penumbra
