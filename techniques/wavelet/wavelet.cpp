#include "techniques/wavelet/wavelet.h"

#include "scenes/error.h"
#include "techniques/bases/for_ranges.h"
#include "techniques/bases/instruction_set.h"
#include "techniques/wavelet/kernel.h"

namespace penumbra {

namespace wavelet {

// Here, not in the header, which nvcc reads: with fmt's headers in sight nvcc 13.0 no longer makes a std::span of a
// std::vector.
Kept::Kept(const Parameters& p, int n, const std::string& owner)
    : terms(p.integer("terms")), gamma(p.number("ranking")) {
  if (const int all = 6 * n * n; terms > all)
    throw Error("{}: terms is {}, but resolution {} has only {}", owner, terms, n, all);
}

void Wavelet::light_changed() {
  for (int c = 0; c < 3; ++c) channel_[c] = light_function(c), kept_[c] = keep_.of(channel_[c]);
}

SparsePlan Wavelet::make_plan(vec3 normal) const {
  SparsePlan plan{Function(n_, cosine_lobe(normal)), {}};
  plan.kept = by_effect_ ? keep_largest_effect(plan.p, channel_, keep_.terms) : keep_.of(plan.p);
  return plan;
}

double Wavelet::multiply(const SparsePlan& plan, int c, const Visibility& v) const {
  Evaluate sink(v);
  triple_product(plan.p, channel_[c], plan.kept, kept_[c], levels_, sink);
  return sink.sum();
}

void Wavelet::collect(const SparsePlan& plan, int c, Collect& sink) const {
  triple_product(plan.p, channel_[c], plan.kept, kept_[c], levels_, sink);
}

Sparse Wavelet::light_by_axis(int c, int axis) const {  // the light is cut, the cosine is whole
  const Function product = times_kept(channel_[c], kept_[c], axis_lobe(axis));
  return {product, keep_largest(product, all_, 0.0)};
}

ProductPlan WaveletProduct::make_plan(vec3 normal) const {
  ProductPlan plan;
  const std::vector<double> lobe = cosine_lobe(normal);
  for (int c = 0; c < 3; ++c) plan.channel[c] = cut(times_light(lobe, c));
  return plan;
}

double WaveletProduct::multiply(const ProductPlan& plan, int c, const Visibility& v) const {
  return inner_product(plan.channel[c], v);
}

void WaveletProduct::collect(const ProductPlan& plan, int c, Collect& sink) const {
  inner_product(plan.channel[c].function, plan.channel[c].kept, sink);
}

Sparse WaveletProduct::light_by_axis(int c, int axis) const {
  return cut(times_light(axis_lobe(axis), c));
}

Sparse WaveletProduct::cut(Function f) const {
  std::vector<Term> kept = keep_.of(f);
  return {std::move(f), std::move(kept)};
}

void WaveletDense::light_changed() {
  for (int c = 0; c < 3; ++c) channel_[c] = light_function(c);
}

DensePlan WaveletDense::make_plan(vec3 normal) const {
  return {normal, Function(n_, cosine_lobe(normal))};
}

double WaveletDense::multiply(const DensePlan& plan, int c, const Visibility& v) const {
  double sum = 0.0;
  for (int face = 0; face < 6; ++face) {
    const auto part = [&](const Function& f) {
      return std::span<const float>(f.coefficients).subspan(std::size_t(face) * n_ * n_, std::size_t(n_) * n_);
    };
    const std::vector<float> vf = haar::coefficients(v.store, face);
    sum += double(haar::triple_product(part(plan.p), part(channel_[c]), std::span<const float>(vf)));
  }
  return sum;
}

void WaveletDense::collect(const DensePlan& plan, int c, Collect& sink) const {  // the inner product with all of L p
  const Function product = times_light(cosine_lobe(plan.normal), c);
  inner_product(product, keep_largest(product, all_, 0.0), sink);
}

Sparse WaveletDense::light_by_axis(int c, int axis) const {
  const Function product = times_light(axis_lobe(axis), c);
  return {product, keep_largest(product, all_, 0.0)};
}

}  // namespace wavelet

namespace {

using namespace wavelet;  // NOLINT: these techniques' own parts

template <class Scalar>
class WaveletSimd final : public Scalar {
  using Scalar::few, Scalar::receivers_, Scalar::visibility_, Scalar::plan_of_, Scalar::active_;

 public:
  using Scalar::Scalar;

  void shade(View<vec3> radiance) override {
    const wavelet::Job job{visibility_.job(), &functionals_, few() ? &active_ : nullptr, &plan_of_.index};
    for_ranges(receivers_->size(), 64, [&](int begin, int end) { wavelet::shade(job, begin, end, radiance.data); });
  }

  Footprint footprint() const override {
    Footprint bytes = Scalar::footprint();
    for (const Functional& f : functionals_) bytes.per_scene += f.bytes();
    return bytes;
  }

  std::string instruction_set() const override { return instruction_set_of_kernels(); }

 private:
  void plans_changed() override { functionals_ = this->make_functionals(); }

  std::vector<Functional> functionals_;
};

/// What the entries of the three say alike; `sparse`: terms are kept.
Entry make_entry(bool sparse) {
  Entry entry;
  entry.lights = {true, false};
  entry.reads_spheres = VisibilitySource::reads_spheres;
  entry.parameters = VisibilitySource::parameters();
  entry.knobs = VisibilitySource::knobs();
  entry.errs_by = sparse ? "terms, table" : "table";
  entry.parity = 1e-4;
  entry.small.set("resolution", 16);
  entry.parameters.push_back(
      choice_parameter("normals", {"exact", "table"}, "the receiver's normal, or the nearest of 6 x 8 x 8"));
  entry.kernels =
      Kernels{.parameters = {choice_parameter("kernels", {"fused", "separate"},
                                              "one kernel, or the paper's three: merge spheres, transform, multiply")},
              .workloads = {parse_parameters({"visibility=raster"}), parse_parameters({"kernels=separate"}),
                            parse_parameters({"kernels=separate", "visibility=raster"})}};
  if (!sparse) return entry;
  entry.parameters.push_back(
      integer_parameter("terms", 200, 1, 6 * 64 * 64, "wavelets", "wavelets kept per channel besides the six scales"));
  entry.parameters.push_back(
      number_parameter("ranking", 1.0, 0.0, 4.0, "", "gamma: terms are ranked by |c| 2^(-gamma level)"));
  entry.knobs.push_back({"terms", {12, 25, 50, 100, 200, 400, 800}, true});
  return entry;
}

}  // namespace

void register_wavelet(Registry& registry) {
  Entry entry = make_entry(true);
  entry.name = "wavelet";
  entry.summary = "pixel/Haar hybrid: sparse triple product of light, cosine and visibility";
  entry.citation = "Zhao & Che 2011; Ng et al. 2004";
  entry.parameters.push_back(choice_parameter("level", {2, 1}, "levels of V in the light's loop: 1 GPU-I, 2 GPU-II"));
  entry.parameters.push_back(choice_parameter("p_level", {1, 2}, "levels of V in the cosine's loop; the paper has 1"));
  entry.parameters.push_back(choice_parameter(
      "p_ranking", {"size", "effect"}, "terms of the cosine kept by their size, or by their effect under the light"));
  entry.kernels->workloads.push_back(parse_parameters({"level=1"}));
  add_pair<Wavelet, WaveletSimd<Wavelet>>(registry, std::move(entry));
}

void register_wavelet_product(Registry& registry) {
  Entry entry = make_entry(true);
  entry.name = "wavelet-product";
  entry.summary = "light x cosine merged per normal, sparse inner product with visibility";
  entry.citation = "Ng et al. 2003; after Zhao & Che 2011";
  add_pair<WaveletProduct, WaveletSimd<WaveletProduct>>(registry, std::move(entry));
}

void register_wavelet_dense(Registry& registry) {
  Entry entry = make_entry(false);
  entry.name = "wavelet-dense";
  entry.summary = "triple product over all terms in linear time";
  entry.citation = "Ng et al. 2004";
  add_pair<WaveletDense, WaveletSimd<WaveletDense>>(registry, std::move(entry));
}

}  // namespace penumbra
