// B = sum over texels t that no occluder blocks of L_t p_t dw_t, p_t = albedo / pi * max(0, N . w_t).
// Exact for its sampling; `visibility` says where the blocked texels come from:
//   rays    the mesh, one ray per texel centre
//   raster  the sphere set, exact caps
//   table   the sphere set through the precomputed table of Zhao & Che 2011
#include "techniques/pixel_basis/pixel_basis.h"

#include <tbb/parallel_for.h>

#include <optional>

#include "scenes/error.h"
#include "techniques/bases/distinct_normals.h"
#include "techniques/pixel_basis/kernel.h"
#include "techniques/registry.h"

namespace penumbra {
namespace {

enum class Visibility { rays, raster, table };

/// What both backends share: the scene's state. Scalar shading is the paper's equation.
class PixelBasis : public Technique {
 public:
  explicit PixelBasis(const Parameters& p)
      : visibility_(p.text("visibility") == "rays"     ? Visibility::rays
                    : p.text("visibility") == "raster" ? Visibility::raster
                                                       : Visibility::table),
        n_(p.integer("resolution")),
        bins_(p.text("bins") == "angle" ? RadiusBins::uniform_angle : RadiusBins::uniform_ratio) {
    if (visibility_ == Visibility::table && n_ > 32)
      throw Error("pixel-basis: the sphere table exists at resolution 16 and 32, not {}; use visibility=raster", n_);
  }

  void prepare(const Scene& scene) override {
    if (visibility_ != Visibility::rays && scene.spheres.empty()) throw Unsupported("the scene has no spheres");
    if (visibility_ == Visibility::rays) rays_.build(scene.mesh);
    if (visibility_ == Visibility::table) table_.emplace(n_, bins_);
    receivers_ = &scene.receivers;
    spheres_ = &scene.spheres;
    set_light(scene.light);
  }

  void update(const Frame& frame) override {
    receivers_ = &frame.receivers;
    spheres_ = &frame.spheres;
    if (frame.changed.mesh && visibility_ == Visibility::rays) rays_.build(frame.mesh);
    if (frame.changed.light) set_light(frame.light);
  }

  void shade(View<vec3> radiance) override {
    for (int i = 0; i < receivers_->size(); ++i) {
      BitCube blocked(n_);
      find_blocked(i, blocked);
      radiance[i] = pixel_sum(light_, blocked, receivers_->normal[i], receivers_->albedo[i]);
    }
  }

  Footprint footprint() const override {
    const std::size_t light = light_.directions.size() * (2 * sizeof(vec3) + sizeof(float));
    return {table_ ? table_->bytes() : 0, rays_.bytes() + light, spheres_ ? spheres_->size() * sizeof(Sphere) : 0};
  }

 protected:
  void find_blocked(int i, BitCube& blocked) const {
    const vec3 x = receivers_->position[i];
    if (visibility_ == Visibility::rays)
      trace_texels(rays_, x, receivers_->normal[i], light_.directions, false, blocked);
    else if (receivers_->on_occluder[i]) return;  // an object's own spheres swallow its surface
    else if (visibility_ == Visibility::raster) rasterise_spheres(*spheres_, x, light_.directions, blocked);
    else merge_spheres(*table_, *spheres_, x, blocked);
  }

  virtual void set_light(const Light& light) { light_ = CubeLight(*environment_of(light), n_); }

  Visibility visibility_;
  int n_;
  RadiusBins bins_;
  RayScene rays_;
  std::optional<SphereTable> table_;
  CubeLight light_;
  const Receivers* receivers_ = nullptr;
  const SphereSet* spheres_ = nullptr;
};

/// Vectorised over spheres and texels, parallel over receivers.
class PixelBasisSimd final : public PixelBasis {
 public:
  using PixelBasis::PixelBasis;

  void prepare(const Scene& scene) override {
    PixelBasis::prepare(scene);
    sphere_lanes_.assign(scene.spheres);
    set_normals(scene.receivers);
  }

  void update(const Frame& frame) override {
    PixelBasis::update(frame);
    if (frame.changed.spheres) sphere_lanes_.assign(frame.spheres);
    if (frame.changed.receivers || frame.changed.light) set_normals(frame.receivers);
  }

  void shade(View<vec3> radiance) override {
    const pixel_basis::Job job{receivers_,
                               &sphere_lanes_,
                               &light_lanes_,
                               table_ ? &*table_ : nullptr,
                               visibility_ == Visibility::rays ? &rays_ : nullptr,
                               &light_.directions,
                               &weights_,
                               &normals_.index};
    tbb::parallel_for(tbb::blocked_range<int>(0, receivers_->size(), 64), [&](const tbb::blocked_range<int>& range) {
      pixel_basis::shade(job, range.begin(), range.end(), radiance.data);
    });
  }

  Footprint footprint() const override {
    Footprint bytes = PixelBasis::footprint();
    bytes.per_scene += 6 * light_.directions.size() * sizeof(float) * (1 + weights_.size() / 2) + normals_.index.size();
    bytes.per_frame += sphere_lanes_.x.size() * 4 * sizeof(float);
    return bytes;
  }

  std::string instruction_set() const override { return pixel_basis::target(); }

 private:
  void set_light(const Light& light) override {
    PixelBasis::set_light(light);
    light_lanes_.assign(light_);
  }

  void set_normals(const Receivers& receivers) {
    normals_ = DistinctNormals::of(receivers);
    weights_.resize(normals_.normals.size());
    for (std::size_t k = 0; k < weights_.size(); ++k) weights_[k].assign(light_lanes_, normals_.normals[k]);
  }

  pixel_basis::SphereLanes sphere_lanes_;
  pixel_basis::LightLanes light_lanes_;
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
    entry.parameters = {
        choice_parameter("visibility", {"table", "raster", "rays"},
                         "sphere table, exact caps of spheres, or rays against the mesh"),
        choice_parameter("resolution", {32, 16, 64}, "texels along a cube face edge"),
        choice_parameter("bins", {"angle", "ratio"}, "radius bins of the table: uniform in the angle or in R / d")};
    if (simd) entry.make = [](const Parameters& p) { return std::make_unique<PixelBasisSimd>(p); };
    else entry.make = [](const Parameters& p) { return std::make_unique<PixelBasis>(p); };
    entry.parity = 1e-4;
    registry.add(std::move(entry));
  }
}

}  // namespace penumbra
