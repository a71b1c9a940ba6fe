#include "techniques/sh_exponentiation/sh_exponentiation.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "scenes/cube_map.h"
#include "scenes/error.h"
#include "techniques/bases/blocked.h"
#include "techniques/bases/instruction_set.h"
#include "techniques/bases/spherical_harmonics/basis.h"
#include "techniques/bases/spherical_harmonics/kernel.h"
#include "techniques/bases/spherical_harmonics/lobes.h"
#include "techniques/bases/spherical_harmonics/straight_line.h"
#include "techniques/bases/spherical_harmonics/tensor.h"
#include "techniques/sh_exponentiation/attribution.h"

namespace penumbra {
namespace sh_exponentiation {

ShExponentiation::ShExponentiation(const Parameters& p)
    : order_(p.integer("order")),
      table_normals_(p.text("normals") == "table"),
      fit_caps_(p.text("fit") == "caps"),
      hierarchy_(p.text("hierarchy") == "on"),
      light_(order_, sh::parse_window(p.text("window"))) {
  job_.order = order_;
  job_.method = {parse_exponential(p.text("exponential")), p.integer("terms"), p.number("tau")};
  job_.replace = p.text("self_shadow") == "replace";
  job_.normals = normal_texels;
  job_.counts = &counts_;
  const sh::Zonal lobe = sh::cosine_lobe(order_);
  for (int l = 0; l < order_; ++l) job_.lobe[l] = float(std::sqrt(4.0 * pi / (2.0 * l + 1.0)) * lobe[l]);
}

void ShExponentiation::prepare(const Scene& scene, const Light& light) {
  if (scene.spheres.empty()) throw Unsupported("the scene has no spheres");
  make_tables();
  set_receivers(scene.receivers);
  set_spheres(scene.spheres, true);
  set_light(light);
}

void ShExponentiation::update(const Frame& frame) {
  if (frame.changed.receivers) set_receivers(frame.receivers);
  job_.receivers = &frame.receivers;
  if (frame.changed.spheres || frame.changed.receivers) set_spheres(frame.spheres, frame.changed.receivers);
  if (frame.changed.light) set_light(frame.light);
}

void ShExponentiation::shade(View<vec3> radiance) {
  begin_frame(radiance);
  for (std::size_t k = 0; k < clusters_.size(); ++k)
    for (const int i : clusters_[k].receivers) radiance[i] = shade_one(i, spheres_of(k));
}

Footprint ShExponentiation::footprint() const {
  Footprint bytes{(table_ ? table_->bytes() : 0) + fit_.a.size() * 2 * sizeof(float), light_.bytes(), tree_.bytes()};
  for (const auto& list : lists_) bytes.per_frame += list.size() * sizeof(WeightedSphere);
  for (const Cluster& c : clusters_) bytes.per_scene += c.receivers.size() * sizeof(int);
  bytes.per_scene += job_.by_normal.size() * sizeof(float);
  return bytes;
}

std::map<std::string, std::size_t> ShExponentiation::counters() const {
  return {{"non_finite", counts_.non_finite}, {"clamped", counts_.clamped}, {"covered_spheres", covered_}};
}

std::vector<Approximation> ShExponentiation::approximations() const {
  return attribute(order_, *job_.receivers, all_, job_.light);
}

void ShExponentiation::begin_frame(View<vec3> radiance) {
  counts_.non_finite = counts_.clamped = 0;
  for (int i = 0; i < job_.receivers->size(); ++i)
    if (!job_.receivers->valid(i)) radiance[i] = vec3(0.0f);
}

/// The equation for one receiver.
vec3 ShExponentiation::shade_one(int i, std::span<const WeightedSphere> spheres) {
  const Receivers& r = *job_.receivers;
  std::vector<double> f(std::size_t(sh::coefficients(order_)), 0.0);
  for (const WeightedSphere& s : spheres) {
    const Shadow shadow =
        shadow_of(s.sphere, r.position[i], r.normal[i], r.on_occluder[i] != 0, job_.replace && !s.bound);
    if (shadow.share == 0.0f) continue;
    const std::vector<double> y = sh::evaluate(order_, shadow.axis);
    for (std::size_t k = 0; k < f.size(); ++k) {
      const int l = sh::band(int(k));
      f[k] += double(shadow.share) * double(s.weight[l]) * table_->look_up(l, double(shadow.cosine)) * y[k];
    }
  }
  const std::vector<double> visibility = exponential(job_.method, fit_, f);
  return reflect(i, visibility);
}

vec3 ShExponentiation::reflect(int i, const std::vector<double>& visibility) {
  const Receivers& r = *job_.receivers;
  const std::vector<double> lobe = sh::rotate_zonal(sh::cosine_lobe(order_), r.normal[i]);
  std::size_t non_finite = 0, clamped = 0;
  vec3 out;
  for (int c = 0; c < 3; ++c) {
    const auto row = std::ptrdiff_t(row_of(r.normal[i]) + std::size_t(c) * lobe.size());
    const auto of_table = [&](auto from) {
      return std::vector<double>(from + row, from + row + std::ptrdiff_t(lobe.size()));
    };
    const std::vector<double> light(job_.light[c].begin(), job_.light[c].end());
    const std::vector<double> product =
        table_normals_ ? of_table(job_.by_normal.begin()) : sh::tensor(order_).product(light, lobe);
    double value = 0.0;
    for (std::size_t k = 0; k < lobe.size(); ++k) value += product[k] * visibility[k];
    const double unshadowed = product[0] * std::sqrt(4.0 * pi);
    out[c] = r.albedo[i][c] * guarded(float(value / pi), float(unshadowed / pi), non_finite, clamped);
  }
  counts_.non_finite += non_finite, counts_.clamped += clamped;
  return out;
}

std::size_t ShExponentiation::row_of(vec3 normal) const {
  return table_normals_ ? std::size_t(cube_texel(normal, normal_texels)) * 3 * sh::coefficients(order_) : 0;
}

void ShExponentiation::make_tables() {
  if (table_) return;
  table_.emplace(order_);
  fit_ = fit_caps_ ? fit_to_caps(*table_) : fit_to_sets(*table_);
  job_.table = &*table_;
  job_.fit = &fit_;
}

void ShExponentiation::set_receivers(const Receivers& receivers) {
  job_.receivers = &receivers;
  edge_ = 0.0f;  // clusters are made anew
}

void ShExponentiation::set_spheres(const SphereSet& spheres, bool moved_receivers) {
  all_ = without_covered(spheres, covered_);
  const Receivers& r = *job_.receivers;
  if (!hierarchy_) {
    if (moved_receivers) {
      clusters_.assign(1, {});
      for (const int i : tile_order(r.width, r.height))
        if (r.valid(i)) clusters_[0].receivers.push_back(i);
    }
    lists_.resize(1);
    lists_[0].clear();
    for (const Sphere& s : all_.spheres) lists_[0].push_back({s});
    return;
  }
  tree_ = SphereTree(all_);
  const float edge = tree_.empty() ? 1.0f : cell_edge(all_, tree_.bound());
  if (edge != edge_) clusters_ = make_clusters(r, edge_ = edge);
  lists_.resize(clusters_.size());
  tbb::parallel_for(std::size_t(0), clusters_.size(),
                    [&](std::size_t k) { tree_.cut(*table_, clusters_[k].bound, lists_[k]); });
}

void ShExponentiation::set_light(const Light& light) {
  const sh::LightCoefficients& coefficients = light_.update(*environment_of(light));
  for (int c = 0; c < 3; ++c) job_.light[c].assign(coefficients.channel[c].begin(), coefficients.channel[c].end());
  if (table_normals_) make_normal_table();
}

/// L * H(N) for the texel centres of a cube map of normals.
void ShExponentiation::make_normal_table() {
  const std::size_t size = std::size_t(sh::coefficients(order_)), texels = 6 * normal_texels * normal_texels;
  job_.by_normal.resize(texels * 3 * size);
  tbb::parallel_for(std::size_t(0), texels, [&](std::size_t t) {
    std::array<float, 36> lobe;
    const vec3 normal = cube_texel_direction(int(t), normal_texels);
    sh::with_order<4, 6>(order_, [&](auto n) { sh::evaluate<n>(normal, lobe.data()); });
    for (std::size_t i = 0; i < size; ++i) lobe[i] *= job_.lobe[sh::band(int(i))];
    for (int c = 0; c < 3; ++c)
      sh::product(order_, job_.light[c].data(), lobe.data(), &job_.by_normal[(t * 3 + c) * size]);
  });
}

}  // namespace sh_exponentiation

namespace {

using namespace sh_exponentiation;  // NOLINT: this technique's own parts

class ShExponentiationSimd final : public ShExponentiation {
 public:
  using ShExponentiation::ShExponentiation;

  void shade(View<vec3> radiance) override {
    begin_frame(radiance);
    tbb::parallel_for(std::size_t(0), clusters_.size(), [&](std::size_t k) {
      const std::span<const int> all = clusters_[k].receivers;
      tbb::parallel_for(tbb::blocked_range<std::size_t>(0, (all.size() + chunk - 1) / chunk), [&](const auto& chunks) {
        for (std::size_t c = chunks.begin(); c < chunks.end(); ++c)
          sh_exponentiation::shade(job_, all.subspan(c * chunk, std::min(chunk, all.size() - c * chunk)), spheres_of(k),
                                   radiance.data);
      });
    });
  }

  std::string instruction_set() const override { return instruction_set_of_kernels(); }

 private:
  static constexpr std::size_t chunk = 64;
};

}  // namespace

void register_sh_exponentiation(Registry& registry) {
  Entry entry;
  entry.name = "sh-exponentiation";
  entry.summary = "logarithms of spheres' visibilities added in spherical harmonics, exponentiated";
  entry.citation = "Ren et al. 2006";
  entry.lights = {true, false};
  entry.parameters = {
      integer_parameter("order", 4, 4, 6, "bands", "spherical harmonics order; order^2 coefficients"),
      choice_parameter("exponential", {"hybrid", "optimal-linear", "power-series", "exact"},
                       "hybrid: halve to |f| <= tau, optimal linear, square back"),
      number_parameter("tau", 0.25, 1e-3, 1e3, "", "hybrid: the size of f at which halving stops"),
      integer_parameter("terms", 9, 0, 64, "powers", "power-series: the highest power"),
      choice_parameter("fit", {"caps", "sets"},
                       "coefficients of optimal-linear; caps: exact on single caps, sets: least squares over sets"),
      choice_parameter("self_shadow", {"replace", "keep"},
                       "what becomes of spheres that poke through the tangent plane"),
      choice_parameter("hierarchy", {"on", "off"}, "bounding spheres in place of spheres that look small"),
      choice_parameter("normals", {"exact", "table"}, "light x cosine per receiver, or from a cube map of normals"),
      choice_parameter("window", {"none", "hann", "lanczos", "laplacian"}, "damps the ringing of the light")};
  entry.knobs = {{"order", {4, 5, 6}, true}};
  entry.errs_by = "few bands";
  entry.parity = 1e-3;
  entry.kernels =
      Kernels{.workloads = {parse_parameters({"order=5"}), parse_parameters({"order=5", "exponential=exact"}),
                            parse_parameters({"order=6"}), parse_parameters({"order=6", "exponential=exact"}),
                            parse_parameters({"exponential=optimal-linear"}),
                            parse_parameters({"exponential=power-series"}), parse_parameters({"exponential=exact"})}};
  add_pair<ShExponentiation, ShExponentiationSimd>(registry, std::move(entry));
}

}  // namespace penumbra
