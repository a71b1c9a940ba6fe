// Wavelet shadows: Zhao & Che 2011, and what its algebra allows beyond.
#pragma once

#include "techniques/wavelet/haar_lighting.h"

namespace penumbra::wavelet {

/// Which wavelets of a function are kept.
struct Kept {
  int terms;
  double gamma;
  /// Throws Error if there are not so many on faces of n x n texels.
  Kept(const Parameters& p, int n, const std::string& owner);
  std::vector<Term> of(const Function& f) const { return keep_largest(f, terms, gamma); }
};

struct SparsePlan {
  static constexpr std::size_t functions = 1, of_light = 3;
  Function p;
  std::vector<Term> kept;
};

/// wavelet: the paper's pipeline, a sparse asymmetric triple product.
class Wavelet : public HaarLighting<SparsePlan> {
 public:
  explicit Wavelet(const Parameters& p)
      : HaarLighting(p, "wavelet"),
        keep_(p, n_, "wavelet"),
        levels_{p.integer("level"), p.integer("p_level")},
        by_effect_(p.text("p_ranking") == "effect") {}

 protected:
  void light_changed() override;
  SparsePlan make_plan(vec3 normal) const override;
  double multiply(const SparsePlan& plan, int c, const Visibility& v) const override;
  void collect(const SparsePlan& plan, int c, Collect& sink) const override;

  Sparse light_by_axis(int c, int axis) const override;

  Kept keep_;
  Levels levels_;
  bool by_effect_;
  Function channel_[3];  ///< of the light
  std::vector<Term> kept_[3];
};

struct ProductPlan {
  static constexpr std::size_t functions = 3, of_light = 0;
  Sparse channel[3];
};

/// wavelet-product: light x BRDF merged per normal, one sparse inner product with V.
class WaveletProduct : public HaarLighting<ProductPlan> {
 public:
  explicit WaveletProduct(const Parameters& p) : HaarLighting(p, "wavelet-product"), keep_(p, n_, "wavelet-product") {}

 protected:
  ProductPlan make_plan(vec3 normal) const override;
  double multiply(const ProductPlan& plan, int c, const Visibility& v) const override;
  void collect(const ProductPlan& plan, int c, Collect& sink) const override;
  Sparse light_by_axis(int c, int axis) const override;
  Sparse cut(Function f) const;

  Kept keep_;
};

struct DensePlan {
  static constexpr std::size_t functions = 1, of_light = 3;
  vec3 normal;
  Function p;
};

/// wavelet-dense: the triple product over all terms, in linear time.
class WaveletDense : public HaarLighting<DensePlan> {
 public:
  explicit WaveletDense(const Parameters& p) : HaarLighting(p, "wavelet-dense") {}

 protected:
  void light_changed() override;
  DensePlan make_plan(vec3 normal) const override;
  double multiply(const DensePlan& plan, int c, const Visibility& v) const override;
  void collect(const DensePlan& plan, int c, Collect& sink) const override;
  Sparse light_by_axis(int c, int axis) const override;

  Function channel_[3];  ///< of the light
};

}  // namespace penumbra::wavelet
