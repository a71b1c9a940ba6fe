#include "techniques/wavelet/wavelet.h"

#include <tbb/parallel_for.h>

#include <algorithm>

#include "scenes/error.h"
#include "techniques/registry.h"
#include "techniques/wavelet/kernel.h"

namespace penumbra {
namespace wavelet {

Wavelet::Wavelet(const Parameters& p, Method method, const std::string& name)
    : method_(method),
      visibility_(p, name),
      n_(visibility_.resolution()),
      all_(6 * n_ * n_),
      terms_(method == Method::dense ? all_ : p.integer("terms")),
      gamma_(method == Method::dense ? 0.0 : p.number("ranking")),
      levels_(method == Method::sparse ? Levels{p.integer("level"), p.integer("p_level")} : Levels{2, 2}),
      by_effect_(method == Method::sparse && p.text("p_ranking") == "effect"),
      table_normals_(p.text("normals") == "table") {
  if (terms_ > all_) throw Error("{}: terms is {}, but resolution {} has only {}", name, terms_, n_, all_);
}

void Wavelet::prepare(const Scene& scene) {
  visibility_.prepare(scene);
  set_light(scene.light);
  set_receivers(scene.receivers);
}

void Wavelet::update(const Frame& frame) {
  visibility_.update(frame);
  receivers_ = &frame.receivers;
  if (frame.changed.light) set_light(frame.light);
  if (frame.changed.light || frame.changed.receivers) set_receivers(frame.receivers);
}

void Wavelet::shade(View<vec3> radiance) {
  Visibility v;
  for (int i = 0; i < receivers_->size(); ++i) {
    radiance[i] = vec3(0.0f);
    if (!receivers_->valid(i)) continue;
    const Plan own = few() ? Plan() : make_plan(normals_[i]);
    const Plan& plan = few() ? plans_[plan_of_.index[i]] : own;
    BitCube blocked(n_);
    visibility_.find_blocked(i, blocked);
    for (std::size_t w = 0; w < blocked.words.size(); ++w)
      if (!(plan.active >> (w / words_per_line) & 1u)) blocked.words[w] = 0;
    v.assign(blocked);
    for (int c = 0; c < 3; ++c) radiance[i][c] = receivers_->albedo[i][c] * float(multiply(plan, c, v));
  }
}

Footprint Wavelet::footprint() const {
  Footprint bytes = visibility_.footprint();
  const std::size_t function = std::size_t(all_) * sizeof(float) * 7 / 3;  // coefficients and mean pyramid
  bytes.tables += haar::binary_table().bytes();
  bytes.per_scene += 3 * function + plans_.size() * (method_ == Method::product ? 3 : 1) * function;
  return bytes;
}

std::vector<double> Wavelet::cosine_lobe(vec3 normal) const {
  std::vector<double> lobe;
  for (const vec3& w : visibility_.directions()) lobe.push_back(std::max(0.0, double(glm::dot(normal, w))) / pi);
  return lobe;
}

Plan Wavelet::make_plan(vec3 normal) const {
  Plan plan;
  plan.active = lines_above_horizon(visibility_.cones(), normal);
  const std::vector<double> lobe = cosine_lobe(normal);
  if (method_ != Method::product) {
    plan.p = Function(n_, lobe);
    if (method_ == Method::sparse)
      plan.kept_p =
          by_effect_ ? keep_largest_effect(plan.p, light_.channel, terms_) : keep_largest(plan.p, terms_, gamma_);
    return plan;
  }
  for (int c = 0; c < 3; ++c) {
    plan.product[c] = Function(n_, times_light(lobe, c));
    plan.kept_product[c] = keep_largest(plan.product[c], terms_, gamma_);
  }
  return plan;
}

std::vector<double> Wavelet::times_light(std::vector<double> values, int c) const {
  for (int t = 0; t < all_; ++t)
    values[t] *= double(light_.texels.radiance[t][c]) * double(light_.texels.solid_angle[t]) * n_ * n_;
  return values;
}

/// The paper's loops, at albedo 1.
double Wavelet::multiply(const Plan& plan, int c, const Visibility& v) const {
  Evaluate sink(v);
  if (method_ == Method::product) {
    inner_product(plan.product[c], plan.kept_product[c], sink);
  } else if (method_ == Method::sparse) {
    triple_product(plan.p, light_.channel[c], plan.kept_p, light_.kept[c], levels_, sink);
  } else {
    double sum = 0.0;
    for (int face = 0; face < 6; ++face) {
      const auto part = [&](const Function& f) {
        return std::span<const float>(f.coefficients).subspan(std::size_t(face) * n_ * n_, std::size_t(n_) * n_);
      };
      const std::vector<float> vf = haar::coefficients(v.store, face);
      sum += double(haar::triple_product(part(plan.p), part(light_.channel[c]), std::span<const float>(vf)));
    }
    return sum;
  }
  return sink.sum();
}

Functional Wavelet::make_functional(const Plan& plan, vec3 normal) const {
  Collect sink(n_);
  for (int c = 0; c < 3; ++c) {
    sink.set_channel(c);
    if (method_ == Method::product) {
      inner_product(plan.product[c], plan.kept_product[c], sink);
    } else if (method_ == Method::sparse) {
      triple_product(plan.p, light_.channel[c], plan.kept_p, light_.kept[c], levels_, sink);
    } else {  // all terms: the inner product with all of L p
      const Function product(n_, times_light(cosine_lobe(normal), c));
      inner_product(product, keep_largest(product, all_, 0.0), sink);
    }
  }
  return sink.take();
}

std::vector<Functional> Wavelet::make_functionals() const {
  std::vector<Functional> all(plans_.size());
  tbb::parallel_for(std::size_t(0), plans_.size(),
                    [&](std::size_t k) { all[k] = make_functional(plans_[k], plan_of_.normals[k]); });
  return all;
}

void Wavelet::set_light(const Light& light) {
  light_.texels = CubeLight(*environment_of(light), n_);
  for (int c = 0; c < 3; ++c) {
    light_.channel[c] = Function(n_, times_light(std::vector<double>(all_, 1.0), c));
    light_.kept[c] = method_ == Method::sparse ? keep_largest(light_.channel[c], terms_, gamma_) : std::vector<Term>();
  }
}

void Wavelet::set_receivers(const Receivers& receivers) {
  receivers_ = &receivers;
  normals_ = receivers.normal;
  if (table_normals_)
    for (vec3& n : normals_)
      if (n != vec3(0.0f)) n = cube_texel_direction(cube_texel(n, 8), 8);
  plan_of_ = DistinctNormals::of(normals_, most_plans + 1);  // and the zero normal of pixels that show nothing
  plans_.resize(plan_of_.normals.size());
  tbb::parallel_for(std::size_t(0), plans_.size(), [&](std::size_t k) { plans_[k] = make_plan(plan_of_.normals[k]); });
}

}  // namespace wavelet

namespace {

using namespace wavelet;  // NOLINT: this technique's own parts

class WaveletSimd final : public Wavelet {
 public:
  using Wavelet::Wavelet;

  void prepare(const Scene& scene) override {
    Wavelet::prepare(scene);
    set_functionals();
  }

  void update(const Frame& frame) override {
    Wavelet::update(frame);
    if (frame.changed.light || frame.changed.receivers) set_functionals();
  }

  void shade(View<vec3> radiance) override {
    const tbb::blocked_range<int> all(0, receivers_->size(), 64);
    tbb::parallel_for(all, [&](const tbb::blocked_range<int>& range) {
      if (few()) {
        shade_range(functionals_, active_, plan_of_.index, range.begin(), range.end(), radiance.data);
        return;
      }
      std::vector<std::uint16_t> zero(std::size_t(receivers_->size()), 0);
      for (int k = range.begin(); k < range.end(); ++k) {  // a functional of its own for every receiver
        const vec3 normal = normals_[(*visibility_.job().order)[k]];
        const Plan plan = make_plan(normal);
        shade_range({make_functional(plan, normal)}, {plan.active}, zero, k, k + 1, radiance.data);
      }
    });
  }

  Footprint footprint() const override {
    Footprint bytes = Wavelet::footprint();
    for (const Functional& f : functionals_) bytes.per_scene += f.bytes();
    return bytes;
  }

  std::string instruction_set() const override { return target(); }

 private:
  void shade_range(const std::vector<Functional>& functionals, const std::vector<std::uint64_t>& active,
                   const std::vector<std::uint16_t>& plan_of, int begin, int end, vec3* radiance) const {
    wavelet::shade({visibility_.job(), &functionals, &active, &plan_of}, begin, end, radiance);
  }

  void set_functionals() {
    functionals_ = make_functionals();
    active_.clear();
    for (const Plan& plan : plans_) active_.push_back(plan.active);
  }

  std::vector<Functional> functionals_;
  std::vector<std::uint64_t> active_;
};

Entry make_entry(const std::string& name, Method method, bool simd) {
  Entry entry;
  entry.name = name;
  entry.backend = simd ? "simd" : "scalar";
  entry.lights = {true, false};
  entry.reads_spheres = VisibilitySource::reads_spheres;
  entry.parameters = VisibilitySource::parameters();
  entry.parameters.push_back(
      choice_parameter("normals", {"exact", "table"}, "the receiver's normal, or the nearest of 6 x 8 x 8"));
  if (method != Method::dense) {
    entry.parameters.push_back(
        integer_parameter("terms", 200, 1, 6 * 64 * 64, "wavelets", "kept per channel besides the six scales"));
    entry.parameters.push_back(
        number_parameter("ranking", 1.0, 0.0, 4.0, "", "gamma: terms are ranked by |c| 2^(-gamma level)"));
  }
  entry.knobs = VisibilitySource::knobs();
  if (method != Method::dense) entry.knobs.push_back({"terms", {12, 25, 50, 100, 200, 400, 800}, true});
  entry.errs_by = method == Method::dense ? "table" : "terms, table";
  if (method == Method::sparse) {
    entry.parameters.push_back(choice_parameter("level", {2, 1}, "levels of V in the light's loop: 1 GPU-I, 2 GPU-II"));
    entry.parameters.push_back(
        choice_parameter("p_level", {1, 2}, "levels of V in the cosine's loop; the paper has 1"));
    entry.parameters.push_back(choice_parameter(
        "p_ranking", {"size", "effect"}, "terms of the cosine kept by their size, or by their effect under the light"));
  }
  if (simd) entry.make = [=](const Parameters& p) { return std::make_unique<WaveletSimd>(p, method, name); };
  else entry.make = [=](const Parameters& p) { return std::make_unique<Wavelet>(p, method, name); };
  entry.parity = 1e-4;
  return entry;
}

}  // namespace

void register_wavelet(Registry& registry) {
  for (const bool simd : {false, true}) {
    Entry sparse = make_entry("wavelet", Method::sparse, simd);
    sparse.summary = "pixel/Haar hybrid: sparse triple product of light, cosine and visibility";
    sparse.citation = "Zhao & Che 2011; Ng et al. 2004";
    registry.add(std::move(sparse));
    Entry product = make_entry("wavelet-product", Method::product, simd);
    product.summary = "light x cosine merged per normal, sparse inner product with visibility";
    product.citation = "Ng et al. 2003; after Zhao & Che 2011";
    registry.add(std::move(product));
    Entry dense = make_entry("wavelet-dense", Method::dense, simd);
    dense.summary = "triple product over all terms in linear time";
    dense.citation = "Ng et al. 2004";
    registry.add(std::move(dense));
  }
}

}  // namespace penumbra
