// B = sum over texels t that no occluder blocks of L_t p_t dw_t, p_t = albedo / pi * max(0, N . w_t).
// Exact for its sampling; bases/visibility_source.h says where the blocked texels come from.
#include "techniques/pixel_basis/pixel_basis.h"

#include <tbb/parallel_for.h>

#include "techniques/bases/distinct_normals.h"
#include "techniques/pixel_basis/kernel.h"
#include "techniques/registry.h"

namespace penumbra {

void PixelBasis::prepare(const Scene& scene) {
  visibility_.prepare(scene);
  receivers_ = &scene.receivers;
  light_ = CubeLight(*environment_of(scene.light), visibility_.resolution());
}

void PixelBasis::update(const Frame& frame) {
  visibility_.update(frame);
  receivers_ = &frame.receivers;
  if (frame.changed.light) light_ = CubeLight(*environment_of(frame.light), visibility_.resolution());
}

void PixelBasis::shade(View<vec3> radiance) {
  for (int i = 0; i < receivers_->size(); ++i) {
    BitCube blocked(visibility_.resolution());
    visibility_.find_blocked(i, blocked);
    radiance[i] = pixel_sum(light_, blocked, receivers_->normal[i], receivers_->albedo[i]);
  }
}

Footprint PixelBasis::footprint() const {
  Footprint bytes = visibility_.footprint();
  bytes.per_scene += light_.directions.size() * (2 * sizeof(vec3) + sizeof(float));
  return bytes;
}

namespace {

/// Vectorised over spheres and texels, parallel over receivers.
class PixelBasisSimd final : public PixelBasis {
 public:
  using PixelBasis::PixelBasis;

  void prepare(const Scene& scene) override {
    PixelBasis::prepare(scene);
    set_weights(scene.receivers);
  }

  void update(const Frame& frame) override {
    PixelBasis::update(frame);
    if (frame.changed.receivers || frame.changed.light) set_weights(frame.receivers);
  }

  void shade(View<vec3> radiance) override {
    const pixel_basis::Job job{visibility_.job(), &energy_, &weights_, &normals_.index};
    tbb::parallel_for(tbb::blocked_range<int>(0, receivers_->size(), 64), [&](const tbb::blocked_range<int>& range) {
      pixel_basis::shade(job, range.begin(), range.end(), radiance.data);
    });
  }

  Footprint footprint() const override {
    Footprint bytes = PixelBasis::footprint();
    bytes.per_scene += 3 * light_.directions.size() * sizeof(float) * (1 + weights_.size()) + normals_.index.size();
    return bytes;
  }

  std::string instruction_set() const override { return pixel_basis::target(); }

 private:
  /// Tables for up to eight distinct normals: 72 KiB each, more would fall out of the cache.
  void set_weights(const Receivers& receivers) {
    energy_.assign(light_);
    normals_ = DistinctNormals::of(receivers.normal);
    weights_.resize(normals_.normals.size());
    for (std::size_t k = 0; k < weights_.size(); ++k)
      weights_[k].assign(energy_, visibility_.cones(), normals_.normals[k]);
  }

  pixel_basis::LightEnergy energy_;
  std::vector<pixel_basis::NormalWeights> weights_;
  DistinctNormals normals_;
};

}  // namespace

void register_pixel_basis(Registry& registry) {
  for (const bool simd : {false, true}) {
    Entry entry;
    entry.name = "pixel-basis";
    entry.backend = simd ? "simd" : "scalar";
    entry.summary = "sum over open texels of a 6 x n x n cube map";
    entry.citation = "Zhao & Che 2011, sections 3.3 and 5";
    entry.lights = {true, false};
    entry.reads_spheres = VisibilitySource::reads_spheres;
    entry.parameters = VisibilitySource::parameters();
    entry.knobs = VisibilitySource::knobs();
    entry.errs_by = "table";
    if (simd) entry.make = [](const Parameters& p) { return std::make_unique<PixelBasisSimd>(p); };
    else entry.make = [](const Parameters& p) { return std::make_unique<PixelBasis>(p); };
    entry.parity = 1e-4;
    registry.add(std::move(entry));
  }
}

}  // namespace penumbra
