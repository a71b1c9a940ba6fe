// Wavelet shadows: Zhao & Che 2011, and what its algebra allows beyond.
//
// Per frame: OR the spheres' bits, transform V through the 4 x 4 table, multiply in the Haar basis.
//
// The solid angle goes into L, as N dw (N pixels a face), so that V stays binary and the ranking sees energy. V is
// taken as open in lines (half faces) that lie wholly below the receiver's horizon: p is 0 there, and nothing need be
// looked up.
//   scalar: the paper's CPU version, a receiver and a channel at a time.
//   simd:   B is linear in V, so the loops over L and p run once per normal and light into a functional of V
//           (sparse_product.h); receivers then share it, sixteen at a time.
#pragma once

#include "techniques/bases/distinct_normals.h"
#include "techniques/bases/visibility_source.h"
#include "techniques/wavelet/sparse_product.h"

namespace penumbra {

class Registry;

/// wavelet:         the paper's pipeline, sparse asymmetric triple product
/// wavelet-product: light x BRDF merged per normal, one sparse inner product with V
/// wavelet-dense:   all terms
void register_wavelet(Registry& registry);

namespace wavelet {

enum class Method { sparse, product, dense };

/// Light, per channel, with the solid angle folded in.
struct LightTerms {
  CubeLight texels;
  Function channel[3];
  std::vector<Term> kept[3];
};

/// All that depends on the normal: the cosine lobe p, or the product of p and L.
struct Plan {
  std::uint64_t active = 0;  ///< lines above the horizon
  Function p;
  std::vector<Term> kept_p;
  Function product[3];
  std::vector<Term> kept_product[3];
};

/// A receiver and a channel at a time; other backends are built upon it.
class Wavelet : public Technique {
 public:
  Wavelet(const Parameters& parameters, Method method, const std::string& name);
  void prepare(const Scene& scene) override;
  void update(const Frame& frame) override;
  void shade(View<vec3> radiance) override;
  Footprint footprint() const override;

 protected:
  /// As many plans as the published table of normals has entries are kept; beyond, each receiver makes its own.
  static constexpr std::size_t most_plans = 6 * 8 * 8;
  bool few() const { return plan_of_.few() || receivers_->size() == 0; }

  Plan make_plan(vec3 normal) const;
  Functional make_functional(const Plan& plan, vec3 normal) const;
  std::vector<Functional> make_functionals() const;  ///< one per plan

  Method method_;
  VisibilitySource visibility_;
  int n_, all_, terms_;
  double gamma_;
  Levels levels_;
  bool by_effect_, table_normals_;
  LightTerms light_;
  const Receivers* receivers_ = nullptr;
  std::vector<vec3> normals_;  ///< per receiver, as used: exact, or the nearest entry of the 6 x 8 x 8 table
  DistinctNormals plan_of_;
  std::vector<Plan> plans_;

 private:
  std::vector<double> cosine_lobe(vec3 normal) const;                        ///< max(0, N . w) / pi by texel
  std::vector<double> times_light(std::vector<double> values, int c) const;  ///< values x L x N dw of a channel
  double multiply(const Plan& plan, int c, const Visibility& v) const;
  void set_light(const Light& light);
  void set_receivers(const Receivers& receivers);
};

}  // namespace wavelet
}  // namespace penumbra
