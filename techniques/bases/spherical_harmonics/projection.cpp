#include "techniques/bases/spherical_harmonics/projection.h"

#include <tbb/parallel_for.h>

#include <cmath>
#include <cstring>
#include <glm/gtc/matrix_transform.hpp>

#include "scenes/error.h"
#include "techniques/bases/random.h"
#include "techniques/bases/spherical_harmonics/basis.h"
#include "techniques/bases/spherical_harmonics/rotation.h"
#include "techniques/bases/spherical_harmonics/straight_line.h"

namespace penumbra::sh {

std::vector<dvec3> stratified_directions(int strata, std::uint64_t seed) {
  if (strata < 1) throw Error("spherical harmonics: {} x {} strata; must be at least 1", strata, strata);
  std::vector<dvec3> directions;
  directions.reserve(std::size_t(strata) * strata);
  for (int a = 0; a < strata; ++a)
    for (int b = 0; b < strata; ++b) {
      const RandomTriple r = random_triple(mix_bits(seed), std::uint32_t(a * strata + b));
      const double xi1 = (a + double(r.x)) / strata, xi2 = (b + double(r.y)) / strata;
      const double theta = 2.0 * std::acos(std::sqrt(1.0 - xi1)), phi = 2.0 * pi * xi2;
      directions.emplace_back(std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta));
    }
  return directions;
}

std::vector<double> project_samples(int order, const std::vector<dvec3>& directions,
                                    const std::function<double(dvec3)>& f) {
  check_order(order);
  std::vector<double> c(std::size_t(coefficients(order)), 0.0);
  for (const dvec3& w : directions) {
    const double value = f(w);
    const std::vector<double> y = evaluate(order, w);
    for (std::size_t i = 0; i < c.size(); ++i) c[i] += value * y[i];
  }
  for (double& value : c) value *= 4.0 * pi / double(directions.size());
  return c;
}

namespace {

/// Adds blocks [0, blocks) of work in order, so that the sum does not depend on threads.
template <class Block>
LightCoefficients sum_blocks(int order, int blocks, Block block) {
  std::vector<LightCoefficients> parts(static_cast<std::size_t>(blocks));
  tbb::parallel_for(0, blocks, [&](int k) {
    for (auto& c : parts[k].channel) c.assign(std::size_t(coefficients(order)), 0.0);
    block(k, parts[k]);
  });
  LightCoefficients sum;
  for (int c = 0; c < 3; ++c) {
    sum.channel[c].assign(std::size_t(coefficients(order)), 0.0);
    for (const LightCoefficients& part : parts)
      for (std::size_t i = 0; i < sum.channel[c].size(); ++i) sum.channel[c][i] += part.channel[c][i];
  }
  return sum;
}

constexpr int rows_per_block = 16;
using Basis = double[max_order * max_order];

void evaluate_at(int order, dvec3 direction, Basis& out) {
  with_order<1, max_order>(order, [&](auto n) { evaluate<n>(direction, out); });
}

/// In the map's frame (x, y, z) = (world z, world x, world y), in which phi is its longitude and z = sin(latitude): the
/// integral over a texel is (integral over its latitudes) x (integral of cos(m phi) or sin(m phi)).
LightCoefficients project_lat_long(int order, const Environment& e) {
  const int width = e.width, height = e.height;
  // Integrals of cos(m phi), sin(m phi) over the columns: [m][column].
  std::vector<double> cosines(std::size_t(order) * width), sines(std::size_t(order) * width);
  for (int m = 0; m < order; ++m)
    for (int x = 0; x < width; ++x) {
      const double right = pi - 2.0 * pi * (x + 1) / width, left = pi - 2.0 * pi * x / width;
      const std::size_t at = std::size_t(m) * width + x;
      cosines[at] = m == 0 ? left - right : (std::sin(m * left) - std::sin(m * right)) / m;
      sines[at] = m == 0 ? 0.0 : (std::cos(m * right) - std::cos(m * left)) / m;
    }
  const GaussLegendre rule = gauss_legendre(16);
  return sum_blocks(order, (height + rows_per_block - 1) / rows_per_block, [&](int block, LightCoefficients& out) {
    std::vector<dvec3> even(static_cast<std::size_t>(order)), odd(static_cast<std::size_t>(order));
    for (int y = block * rows_per_block; y < std::min(height, (block + 1) * rows_per_block); ++y) {
      for (int m = 0; m < order; ++m) {
        dvec3 c(0.0), s(0.0);
        for (int x = 0; x < width; ++x) {
          const dvec3 radiance(e.radiance[std::size_t(y) * width + x]);
          c += radiance * cosines[std::size_t(m) * width + x];
          s += radiance * sines[std::size_t(m) * width + x];
        }
        even[m] = c, odd[m] = s;
      }
      const double middle = 0.5 * pi - pi * (y + 0.5) / height, half = 0.5 * pi / height;
      for (std::size_t p = 0; p < rule.node.size(); ++p) {
        const double latitude = middle + half * rule.node[p];
        // At phi = 0 the basis shows its polar part: Y_lm for m >= 0.
        Basis polar;
        evaluate_at(order, {std::cos(latitude), 0.0, std::sin(latitude)}, polar);
        const double weight = rule.weight[p] * half * std::cos(latitude);
        for (int l = 0; l < order; ++l)
          for (int m = 0; m <= l; ++m)
            for (int c = 0; c < 3; ++c) {
              out.channel[c][index(l, m)] += weight * polar[index(l, m)] * even[m][c];
              if (m > 0) out.channel[c][index(l, -m)] += weight * polar[index(l, m)] * odd[m][c];
            }
      }
    }
  });
}

LightCoefficients project_cube(int order, const Environment& e) {
  const int n = e.width;
  const GaussLegendre rule = gauss_legendre(n >= 16 ? 4 : 16);
  const CubeMapping mapping = e.cube();
  return sum_blocks(order, 6 * n, [&](int y, LightCoefficients& out) {
    for (int x = 0; x < n; ++x)
      for (std::size_t p = 0; p < rule.node.size(); ++p)
        for (std::size_t q = 0; q < rule.node.size(); ++q) {
          const double column = x + 0.5 + 0.5 * rule.node[p], row = y + 0.5 + 0.5 * rule.node[q];
          const double s = 2.0 * column / n - 1.0, t = 2.0 * (row - (y - y % n)) / n - 1.0;
          // dw = ds dt / (1 + s^2 + t^2)^(3/2)
          const double solid_angle =
              rule.weight[p] * rule.weight[q] / (double(n) * n) * std::pow(1.0 + s * s + t * t, -1.5);
          Basis basis;
          evaluate_at(order, mapping.direction(column, row), basis);
          for (int c = 0; c < 3; ++c) {
            const double weight = double(e.radiance[std::size_t(y) * n + x][c]) * solid_angle;
            for (int i = 0; i < coefficients(order); ++i) out.channel[c][i] += weight * basis[i];
          }
        }
  });
}

/// Columns are the world directions of the axes that the projection of a mapping is done in.
glm::dmat3 frame_of(Mapping mapping) {
  return mapping == Mapping::cube ? glm::dmat3(1.0) : glm::dmat3({0, 0, 1}, {1, 0, 0}, {0, 1, 0});
}

LightCoefficients rotate(int order, const LightCoefficients& light, const glm::dmat3& turn) {
  const Rotation rotation(order, turn);
  LightCoefficients out;
  for (int c = 0; c < 3; ++c) out.channel[c] = rotation(light.channel[c]);
  return out;
}

}  // namespace

LightCoefficients project_texels(int order, const Environment& environment) {
  check_order(order);
  if (environment.mapping == Mapping::cube) return project_cube(order, environment);
  return rotate(order, project_lat_long(order, environment), frame_of(Mapping::lat_long));
}

const LightCoefficients& LightProjection::update(const Environment& environment) {
  const auto& image = environment.radiance;
  if (image_.size() != image.size() || std::memcmp(image_.data(), image.data(), image.size() * sizeof(vec3)) != 0) {
    own_frame_ = project_texels(order_, environment);
    image_ = image;
  }
  const double c = std::cos(environment.rotation), s = std::sin(environment.rotation);
  world_ = rotate(order_, own_frame_, glm::dmat3({c, 0, -s}, {0, 1, 0}, {s, 0, c}));
  for (auto& channel : world_.channel) apply_window(window_, channel);
  return world_;
}

}  // namespace penumbra::sh
