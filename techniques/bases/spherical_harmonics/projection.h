// From functions on the sphere to coefficients: c_i = integral of f Y_i.
#pragma once

#include <functional>
#include <vector>

#include "scenes/environment.h"
#include "techniques/bases/spherical_harmonics/lobes.h"

namespace penumbra::sh {

/// strata x strata cells of (xi_1, xi_2), theta = 2 acos sqrt(1 - xi_1), phi = 2 pi xi_2, one jittered sample in each
/// (Green 2003, section 2). A pure function of the seed.
std::vector<dvec3> stratified_directions(int strata, std::uint64_t seed);

/// (4 pi / M) sum of f y_i over M directions.
std::vector<double> project_samples(int order, const std::vector<dvec3>& directions,
                                    const std::function<double(dvec3)>& f);

/// Coefficients of radiance by channel, order^2 each.
struct LightCoefficients {
  std::vector<double> channel[3];
};

/// Exact to rounding: the environment is constant over a texel, and Y_i is integrated over each in closed form in phi
/// and by Gauss-Legendre in theta (latitude-longitude) or over the face (cube). In the environment's own frame:
/// rotation is left out.
LightCoefficients project_texels(int order, const Environment& environment);

/// The light's windowed coefficients in world space, kept between frames: a light that only turned is not projected
/// again.
class LightProjection {
 public:
  /// `order` 1 to max_order.
  explicit LightProjection(int order, Window kind = Window::none) : order_(order), window_(window(kind, order)) {}
  const LightCoefficients& update(const Environment& environment);
  std::size_t bytes() const { return image_.size() * sizeof(vec3); }

 private:
  int order_;
  std::vector<double> window_;
  std::vector<vec3> image_;  ///< that was projected last
  LightCoefficients own_frame_, world_;
};

}  // namespace penumbra::sh
