#include "techniques/sh_lighting/sh_lighting.h"

#include <tbb/parallel_for.h>

#include "techniques/registry.h"
#include "techniques/sh_lighting/kernel.h"

namespace penumbra {
namespace sh_lighting {

ShLighting::ShLighting(const Parameters& p, bool packets)
    : order_(p.integer("order")),
      directions_(p.integer("directions")),
      seed_(std::uint64_t(p.integer("seed"))),
      projection_(order_, sh::parse_window(p.text("window"))) {
  const std::string& transfer = p.text("transfer");
  request_.transfer = transfer == "unshadowed" ? Transfer::unshadowed
                      : transfer == "shadowed" ? Transfer::shadowed
                                               : Transfer::interreflected;
  request_.estimator = p.text("estimator") == "plain" ? Estimator::plain : Estimator::complement;
  request_.bounces = p.integer("bounces");
  request_.packets = packets;
}

void ShLighting::prepare(const Scene& scene) {
  request_.mesh_albedo = scene.receiver_spec.albedo;
  if (!set_) set_.emplace(order_, directions_, seed_);
  rays_.build(scene.mesh);
  set_transfer(scene.mesh, scene.receivers);
  set_light(scene.light);
}

void ShLighting::update(const Frame& frame) {
  receivers_ = &frame.receivers;
  if (frame.changed.mesh) rays_.build(frame.mesh);
  if (frame.changed.mesh || frame.changed.receivers) set_transfer(frame.mesh, frame.receivers);
  if (frame.changed.light) set_light(frame.light);
}

void ShLighting::shade(View<vec3> radiance) {
  for (int i = 0; i < receivers_->size(); ++i)
    for (int c = 0; c < 3; ++c) {
      const float* row = transfer_.at(std::size_t(i), transfer_.channels == 3 ? c : 0);
      double sum = 0.0;
      for (int k = 0; k < transfer_.row; ++k) sum += double(light_[c][k]) * double(row[k]);
      radiance[i][c] = receivers_->albedo[i][c] * float(sum);
    }
}

Footprint ShLighting::footprint() const {
  return {set_ ? set_->bytes() : 0, rays_.bytes() + transfer_.values.size() * sizeof(float) + projection_.bytes(),
          3 * light_[0].size() * sizeof(float)};
}

void ShLighting::set_transfer(const Mesh& mesh, const Receivers& receivers) {
  receivers_ = &receivers;
  transfer_ = compute_transfer(request_, *set_, rays_, mesh, receivers);
}

void ShLighting::set_light(const Light& light) {
  const sh::LightCoefficients& coefficients = projection_.update(*environment_of(light));
  for (int c = 0; c < 3; ++c) {
    light_[c].assign(coefficients.channel[c].begin(), coefficients.channel[c].end());
    light_[c].resize(std::size_t(set_->row), 0.0f);
  }
}

}  // namespace sh_lighting

namespace {

using namespace sh_lighting;  // NOLINT: this technique's own parts

class ShLightingSimd final : public ShLighting {
 public:
  explicit ShLightingSimd(const Parameters& p) : ShLighting(p, true) {}

  void shade(View<vec3> radiance) override {
    tbb::parallel_for(tbb::blocked_range<int>(0, receivers_->size(), 1024), [&](const tbb::blocked_range<int>& range) {
      sh_lighting::shade(transfer_, light_, receivers_->albedo, range.begin(), range.end(), radiance.data);
    });
  }

  std::string instruction_set() const override { return sh_lighting::target(); }
};

}  // namespace

void register_sh_lighting(Registry& registry) {
  for (const bool simd : {false, true}) {
    Entry entry;
    entry.name = "sh-lighting";
    entry.backend = simd ? "simd" : "scalar";
    entry.summary = "light . precomputed diffuse transfer in spherical harmonics";
    entry.citation = "Green 2003; Sloan et al. 2002";
    entry.lights = {true, false};
    entry.reads_spheres = [](const Parameters&) { return false; };
    entry.parameters = {
        choice_parameter(
            "transfer", {"shadowed", "unshadowed", "interreflected"},
            "what reaches a receiver; interreflected adds light that the mesh reflects, which truth has not"),
        integer_parameter("order", 4, 2, 6, "bands", "spherical harmonics order; order^2 coefficients"),
        integer_parameter("directions", 10000, 16, 1 << 20, "rays", "per receiver, rounded to a square number"),
        integer_parameter("bounces", 1, 0, 16, "", "interreflected: how often light is reflected on its way"),
        choice_parameter("estimator", {"complement", "plain"},
                         "complement: exact cosine lobe less the blocked directions; plain: sum of the open ones"),
        choice_parameter("window", {"none", "hann", "lanczos", "laplacian"}, "damps the ringing of the light"),
        integer_parameter("seed", 1, 0, 1 << 30, "", "of the directions: same seed, same image")};
    entry.knobs = {{"order", {2, 3, 4, 5, 6}, true}};
    entry.errs_by = "few bands";
    if (simd) entry.make = [](const Parameters& p) { return std::make_unique<ShLightingSimd>(p); };
    else entry.make = [](const Parameters& p) { return std::make_unique<ShLighting>(p); };
    entry.parity = 1e-3;  // Embree's packet and single-ray traversals may round an edge differently
    registry.add(std::move(entry));
  }
}

}  // namespace penumbra
