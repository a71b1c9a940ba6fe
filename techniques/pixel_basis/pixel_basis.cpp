// B = sum over texels t that no occluder blocks of L_t p_t dw_t, p_t = albedo / pi * max(0, N . w_t).
// Exact for its sampling; bases/visibility_source.h says where the blocked texels come from.
#include "techniques/pixel_basis/pixel_basis.h"

#include "techniques/bases/for_ranges.h"
#include "techniques/bases/instruction_set.h"
#include "techniques/pixel_basis/kernel.h"
#include "techniques/registry.h"

namespace penumbra {

void PixelBasis::prepare(const Scene& scene, const Light& light) {
  visibility_.prepare(scene);
  receivers_ = &scene.receivers;
  light_ = CubeLight(*environment_of(light), visibility_.resolution());
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

/// Vectorised over spheres and rows, parallel over receivers; sums of light by axis, for any normal.
class PixelBasisSimd final : public PixelBasis {
 public:
  using PixelBasis::PixelBasis;

  void prepare(const Scene& scene, const Light& light) override {
    PixelBasis::prepare(scene, light);
    sums_.assign(light_);
  }

  void update(const Frame& frame) override {
    PixelBasis::update(frame);
    if (frame.changed.light) sums_.assign(light_);
  }

  void shade(View<vec3> radiance) override {
    const pixel_basis::Job job{visibility_.job(), &sums_};
    for_ranges(receivers_->size(), 64, [&](int begin, int end) { pixel_basis::shade(job, begin, end, radiance.data); });
  }

  Footprint footprint() const override {
    Footprint bytes = PixelBasis::footprint();
    bytes.per_scene += sums_.bytes();
    return bytes;
  }

  std::string instruction_set() const override { return instruction_set_of_kernels(); }

 private:
  pixel_basis::LightSums sums_;
};

}  // namespace

void register_pixel_basis(Registry& registry) {
  Entry entry;
  entry.name = "pixel-basis";
  entry.summary = "sum over open texels of a 6 x n x n cube map";
  entry.citation = "Zhao & Che 2011, sections 3.3 and 5";
  entry.lights = {true, false};
  entry.reads_spheres = VisibilitySource::reads_spheres;
  entry.parameters = VisibilitySource::parameters();
  entry.knobs = VisibilitySource::knobs();
  entry.errs_by = "table";
  entry.small.set("resolution", 16);
  entry.parity = 1e-4;
  entry.kernels = Kernels{.workloads = {parse_parameters({"visibility=raster"})}};
  add_pair<PixelBasis, PixelBasisSimd>(registry, std::move(entry));
}

}  // namespace penumbra
