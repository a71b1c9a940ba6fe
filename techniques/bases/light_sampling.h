// Sampling of lights for Monte Carlo shadows: environments by the product of radiance and cosine, area lights by area.
//
// Environment: the image is cut into cells of a few degrees, ordered along a Morton curve. For a normal N a cell's
// probability is (its luminance integral) x (the largest cosine to N within it); inside the cell a texel is chosen by
// luminance x solid angle, and a point uniformly in the texel. Equal strata of the one number u that drives cell and
// texel are compact patches of the sphere, so stratifying u stratifies directions (in the manner of Clarberg & Jarosz
// 2005, flattened to two levels).
#pragma once

#include <vector>

#include "scenes/light.h"

namespace penumbra {

/// A direction (or a point of the light) and what it brings: the estimate of reflected radiance at albedo 1 is the mean
/// of weight * V over samples, weight = L cos / (pi pdf).
struct LightSample {
  vec3 direction;  ///< unit, from receiver to light
  float distance;  ///< to the light; infinity for environments
  vec3 weight;
  float reach() const { return distance * (1.0f - 1e-4f); }  ///< where a shadow ray ends
};

class EnvironmentSampler {
 public:
  EnvironmentSampler() = default;
  /// Keeps a reference to the environment.
  explicit EnvironmentSampler(const Environment& environment);

  /// Distribution over cells for one normal. Reusable storage.
  struct Product {
    vec3 normal{0.0f};
    std::vector<double> cumulative;  ///< inclusive sums of cell weights
    double total() const { return cumulative.empty() ? 0.0 : cumulative.back(); }
  };
  void make_product(vec3 normal, Product& product) const;

  /// u in [0, 1) chooses cell and texel, (v, w) the point within the texel. Weight 0 if the product is black.
  LightSample sample(const Product& product, double u, float v, float w) const;

  /// Reflected radiance at albedo 1 without any occluder: the sum over all texels, cosine at their centres.
  vec3 unshadowed(vec3 normal) const;

  std::size_t bytes() const;

 private:
  struct Cell {
    int first, count;  ///< range in texels_
  };
  void add_cell(int x0, int x1, int y0, int y1);

  const Environment* environment_ = nullptr;
  std::vector<Cell> cells_;
  std::vector<int> texels_;
  std::vector<double> cumulative_;  ///< within each cell: inclusive sums of luminance * solid angle; double, so that
                                    ///< dim texels beside a sun keep their share
  std::vector<float> axis_x_, axis_y_, axis_z_, cos_radius_, sin_radius_, energy_;  ///< per cell: bounding cone, sum
};

/// k stratified samples of whatever light there is. Keeps a reference to the light.
class LightSampler {
 public:
  LightSampler() = default;
  explicit LightSampler(const Light& light);

  /// Reusable storage of one thread. Equal normals in a row share their product.
  struct Scratch {
    EnvironmentSampler::Product product;
    std::vector<LightSample> samples;
  };
  /// Fills scratch.samples. Samples are a pure function of the arguments; `stream` tells independent sets apart.
  /// Environment: u = (i + jitter) / k. Area light: Hammersley points, randomly shifted (Cranley & Patterson 1976).
  void draw(vec3 position, vec3 normal, int k, std::uint64_t stream, Scratch& scratch) const;

  /// Scales the samples of one normal, channel by channel, so that unoccluded they give exactly what arrives. The
  /// estimate becomes (exact unshadowed light) x (estimated share that is visible), the ratio estimator of Heitz et al.
  /// 2018: no noise where nothing is in the way, a bias of order 1 / k elsewhere.
  static void normalise(vec3 unshadowed, std::vector<LightSample>& samples);
  /// Environments: reflected radiance at albedo 1 without any occluder.
  vec3 unshadowed(vec3 normal) const { return environment_.unshadowed(normal); }

  std::size_t bytes() const { return environment_.bytes(); }

 private:
  const AreaLight* area_ = nullptr;
  EnvironmentSampler environment_;
};

class RayScene;

/// Mean of weight * V over the samples of a receiver, whose rays start at `origin`: reflected radiance at albedo 1, one
/// ray after the other. Light that arrives from below the horizon costs no ray.
vec3 estimate_radiance(const RayScene& rays, vec3 origin, const std::vector<LightSample>& samples);

/// What a point of an area light brings at radiance 1, chosen evenly by area: weight A cos cos / (pi distance^2), 0
/// from behind either surface. `to_light`: from the receiver to the point, m.
LightSample sample_point(const AreaLight& light, vec3 to_light, vec3 normal);

/// Light from the point (u, v) in [0, 1]^2 of an area light; weight 0 from behind either surface.
LightSample sample_area(const AreaLight& light, vec3 position, vec3 normal, float u, float v);

}  // namespace penumbra
