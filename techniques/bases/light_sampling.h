// Sampling of lights for Monte Carlo shadows: environments by the product of radiance and cosine, area lights by area.
//
// Environment: the image is cut into cells of a few degrees, ordered along a Morton curve. For a normal N a cell's
// probability is (its luminance integral) x (the largest cosine to N within it); inside the cell a texel is chosen by
// luminance x solid angle, and a point uniformly in the texel. Equal strata of the one number u that drives cell and
// texel are compact patches of the sphere, so stratifying u stratifies directions (in the manner of Clarberg & Jarosz
// 2005, flattened to two levels).
//
// One distribution may serve all normals within a cone: the largest cosine is then that of any of them to any direction
// of the cell, so it is positive wherever one of them sees light. Its samples keep L / (pi pdf), and every receiver
// weighs them by its own cosine: unbiased for each, and a sample below its own horizon costs it no ray.
#pragma once

#include <span>
#include <vector>

#include "scenes/light.h"
#include "techniques/bases/cap.h"

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

  /// Distribution over cells for one normal or a cone of them. Reusable storage.
  struct Product {
    Cone normals{vec3(0.0f), 0.0f, 1.0f};
    std::vector<double> cumulative;  ///< inclusive sums of cell weights
    double total() const { return cumulative.empty() ? 0.0 : cumulative.back(); }
    std::size_t bytes() const { return cumulative.size() * sizeof(double); }
  };
  void make_product(const Cone& normals, Product& product) const;

  /// u in [0, 1) chooses cell and texel, (v, w) the point within the texel; the weight is that of the normal on the
  /// axis. Weight 0 if the product is black.
  LightSample sample(const Product& product, double u, float v, float w) const;
  /// The same sample for whatever normal: its weight is that of cosine 1.
  LightSample shared_sample(const Product& product, double u, float v, float w) const;

  /// Reflected radiance at albedo 1 without any occluder: the sum over all texels, cosine at their centres.
  vec3 unshadowed(vec3 normal) const;

  std::size_t bytes() const;

 private:
  struct Cell {
    int first, count;  ///< range in texels_
  };
  struct Choice {
    int texel;
    vec3 direction;
    double pdf;  ///< per sr
  };
  void add_cell(int x0, int x1, int y0, int y1);
  Choice choose(const Product& product, double u, float v, float w) const;

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
    std::vector<LightSample> samples, shared;
  };
  /// Fills scratch.samples. Samples are a pure function of the arguments; `stream` tells independent sets apart.
  /// Environment: u = (i + jitter) / k. Area light: Hammersley points, randomly shifted (Cranley & Patterson 1976).
  void draw(vec3 position, vec3 normal, int k, std::uint64_t stream, Scratch& scratch) const;

  /// Environments: k samples for every normal of a cone, stratified as those of draw(), with the weights of cosine 1.
  void draw_shared(const EnvironmentSampler::Product& product, int k, std::uint64_t stream,
                   std::vector<LightSample>& samples) const;
  /// Shared samples as one normal sees them.
  static void face(std::span<const LightSample> shared, vec3 normal, std::vector<LightSample>& own);
  void make_product(const Cone& normals, EnvironmentSampler::Product& product) const {
    environment_.make_product(normals, product);
  }

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
