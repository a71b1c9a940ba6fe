#include "techniques/sh_lighting/sh_lighting.h"

#include "techniques/bases/for_ranges.h"
#include "techniques/bases/instruction_set.h"
#include "techniques/bases/spherical_harmonics/kernel.h"
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

void ShLighting::prepare(const Scene& scene, const Light& light) {
  request_.mesh_albedo = scene.receiver_spec.albedo;
  if (!set_) set_.emplace(order_, directions_, seed_);
  rays_.build(scene.mesh);
  set_transfer(scene.mesh, scene.receivers);
  set_light(light);
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
    for_ranges(receivers_->size(), 1024, [&](int begin, int end) {
      sh_lighting::shade(transfer_, light_, receivers_->albedo, begin, end, radiance.data);
    });
  }

  std::string instruction_set() const override { return instruction_set_of_kernels(); }
};

}  // namespace

void register_sh_lighting(Registry& registry) {
  Entry entry;
  entry.name = "sh-lighting";
  entry.summary = "light . precomputed diffuse transfer in spherical harmonics";
  entry.citation = "Green 2003; Sloan et al. 2002";
  entry.lights = {true, false};
  entry.reads_spheres = [](const Parameters&) { return false; };
  entry.parameters = {
      choice_parameter(
          "transfer", {"shadowed", "unshadowed", "interreflected"},
          "what reaches a receiver; interreflected adds light that the mesh reflects, which truth has not"),
      integer_parameter("order", 4, 2, 6, "bands", "spherical harmonics order; order^2 coefficients"),
      integer_parameter("directions", 10000, 16, 1 << 20, "rays", "rays per receiver, rounded to a square number"),
      integer_parameter("bounces", 1, 0, 16, "", "interreflected: how often light is reflected on its way"),
      choice_parameter("estimator", {"complement", "plain"},
                       "complement: exact cosine lobe less the blocked directions; plain: sum of the open ones"),
      choice_parameter("window", {"none", "hann", "lanczos", "laplacian"}, "damps the ringing of the light"),
      integer_parameter("seed", 1, 0, 1 << 30, "", "seed of the directions: same seed, same image")};
  entry.knobs = {{"order", {2, 3, 4, 5, 6}, true}};
  entry.errs_by = "few bands";
  entry.small.set("directions", 64);
  entry.parity = 1e-3;  // Embree's packet and single-ray traversals may round an edge differently
  entry.kernels.emplace();
  for (const int order : {2, 3, 5, 6}) entry.kernels->workloads.emplace_back().set("order", order);
  add_pair<ShLighting, ShLightingSimd>(registry, std::move(entry));
}

}  // namespace penumbra
