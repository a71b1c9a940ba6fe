// Spherical harmonic lighting with precomputed diffuse transfer (Green 2003; Sloan et al. 2002).
//
// B = albedo * sum of L_i T_i: transfer T at receivers is precomputed for a mesh at rest; the light may turn and
// change.
//   scalar: a ray and a number at a time.
//   simd:   rays in packets, sums over vectors of coefficients, receivers in parallel.
#pragma once

#include <array>
#include <optional>

#include "techniques/bases/spherical_harmonics/projection.h"
#include "techniques/registry.h"
#include "techniques/sh_lighting/transfer.h"

namespace penumbra::sh_lighting {

/// Other backends are built upon it.
class ShLighting : public Technique {
 public:
  explicit ShLighting(const Parameters& p, bool packets = false);
  void prepare(const Scene& scene, const Light& light) override;
  void update(const Frame& frame) override;
  void shade(View<vec3> radiance) override;
  Footprint footprint() const override;

 protected:
  virtual void set_transfer(const Mesh& mesh, const Receivers& receivers);

  int order_;
  std::optional<DirectionSet> set_;
  Request request_;
  RayScene rays_;
  TransferVectors transfer_;
  std::array<std::vector<float>, 3> light_;  ///< by channel: a row, windowed
  const Receivers* receivers_ = nullptr;

 private:
  void set_light(const Light& light);

  int directions_;
  std::uint64_t seed_;
  sh::LightProjection projection_;
};

}  // namespace penumbra::sh_lighting
