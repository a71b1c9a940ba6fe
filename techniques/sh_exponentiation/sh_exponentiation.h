// Soft shadows from spheres by exponentiation of spherical harmonics (Ren et al. 2006).
//
// B = albedo / pi (L * H(N)) . exp*(sum over spheres of log* v), v the visibility behind one sphere, H the cosine lobe.
//   scalar: the equation, a receiver at a time in double precision; exact is by eigenvectors.
//   simd:   receivers side by side in float; exact by scaled Taylor series (kernel.cpp).
#pragma once

#include <optional>

#include "techniques/bases/spherical_harmonics/projection.h"
#include "techniques/registry.h"
#include "techniques/sh_exponentiation/kernel.h"

namespace penumbra::sh_exponentiation {

constexpr int normal_texels = 32;  ///< along an edge of the table of normals

/// Other backends are built upon it.
class ShExponentiation : public Technique {
 public:
  explicit ShExponentiation(const Parameters& p);
  void prepare(const Scene& scene, const Light& light) override;
  void update(const Frame& frame) override;
  void shade(View<vec3> radiance) override;
  Footprint footprint() const override;
  std::map<std::string, std::size_t> counters() const override;
  std::vector<Approximation> approximations() const override;

 protected:
  std::span<const WeightedSphere> spheres_of(std::size_t cluster) const { return lists_[hierarchy_ ? cluster : 0]; }
  void begin_frame(View<vec3> radiance);

  int order_;
  bool table_normals_;
  Job job_;
  std::vector<Cluster> clusters_;
  mutable Counts counts_;

 private:
  vec3 shade_one(int i, std::span<const WeightedSphere> spheres);
  vec3 reflect(int i, const std::vector<double>& visibility);
  std::size_t row_of(vec3 normal) const;
  void make_tables();
  void set_receivers(const Receivers& receivers);
  void set_spheres(const SphereSet& spheres, bool moved_receivers);
  void set_light(const Light& light);
  void make_normal_table();

  bool fit_caps_, hierarchy_;
  std::optional<LogTable> table_;
  LinearFit fit_;
  sh::LightProjection light_;
  SphereSet all_;
  SphereTree tree_;
  std::vector<std::vector<WeightedSphere>> lists_;  ///< per cluster; one for all without a hierarchy
  float edge_ = 0.0f;
  std::size_t covered_ = 0;
};

}  // namespace penumbra::sh_exponentiation
