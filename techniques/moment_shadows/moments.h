// Four moments of depth over any rectangle of the shadow map, and what they say about a receiver (Peters & Klein 2015,
// "Moment shadow mapping"; Peters et al. 2016, "Beyond hard shadows", for soft shadows by summed-area tables).
//
// The least shadow that any distribution of depths with moments b1 to b4 can cast at depth z0 is that of three depths
// z0, z1, z2 (Hamburger's problem). With two depths in the region the answer is exact.
#pragma once

#include <array>
#include <cmath>
#include <vector>

#include "techniques/bases/shadow_map/shadow_map.h"

namespace penumbra::moment_shadows {
using namespace shadow_map;  // NOLINT: its base

/// Depth from 0 at the nearest occluder to 0.8 at the farthest receiver, at most 1; b_j = mean of depth^j.
using Moments = std::array<double, 4>;

/// Summed-area table (Crow 1984) of four powers of depth; (edge + 1)^2 entries, the first row and column 0.
class MomentTable {
 public:
  void build(const ShadowMap& map, float far);

  double normalised(float z) const { return (double(z) - near_) * scale_; }
  float depth(double normalised) const { return float(near_ + normalised / scale_); }
  /// Mean over texels; those outside the map lie at depth 1.
  Moments mean(const Texels& texels) const;
  int edge() const { return edge_; }
  const double* sums(int power) const { return sums_[power].data(); }
  double near() const { return near_; }
  double scale() const { return scale_; }
  std::size_t bytes() const { return 4 * sums_[0].size() * sizeof(double); }

 private:
  int edge_ = 0;
  double near_ = 0.0, scale_ = 1.0;
  std::array<std::vector<double>, 4> sums_;
};

/// z0 and the two other depths of the canonical distribution, z1 <= z2, with the weight of z0.
struct ThreeDepths {
  double z1, z2, weight0, weight1;
};

/// `bias` in (0, 1) mixes in the moments of all depths alike, so that no region has only one depth or two: the
/// equations would be singular, and rounding decide.
PENUMBRA_HD inline Moments biased(const Moments& b, double bias) {
  Moments out{};
  for (int j = 0; j < 4; ++j) out[std::size_t(j)] = b[std::size_t(j)] + bias * (1.0 / (j + 2) - b[std::size_t(j)]);
  return out;
}

PENUMBRA_HD inline ThreeDepths three_depths(const Moments& b, double z0) {
  // Cholesky factors of the Hankel matrix (1 b1 b2; b1 b2 b3; b2 b3 b4), and c with (Hankel) c = (1, z0, z0^2).
  const double d22 = b[1] - b[0] * b[0], l32d22 = b[2] - b[0] * b[1];
  const double d33d22 = (b[3] - b[1] * b[1]) * d22 - l32d22 * l32d22;
  const double l32 = l32d22 / d22;
  double c1 = z0 - b[0], c2 = z0 * z0 - b[1] - l32 * c1;
  c1 /= d22;
  c2 *= d22 / d33d22;
  c1 -= l32 * c2;
  const double c0 = 1.0 - (c1 * b[0] + c2 * b[1]);
  // z1 and z2 are the roots of c2 z^2 + c1 z + c0.
  const double p = c1 / c2, q = c0 / c2, inside = 0.25 * p * p - q;
  const double r = std::sqrt(inside > 0.0 ? inside : 0.0);
  const double z1 = -0.5 * p - r, z2 = -0.5 * p + r;
  const double weight0 = (z1 * z2 - b[0] * (z1 + z2) + b[1]) / ((z0 - z1) * (z0 - z2));
  const double weight1 = (z0 * z2 - b[0] * (z0 + z2) + b[1]) / ((z1 - z0) * (z1 - z2));
  return {z1, z2, weight0, weight1};
}

/// Share of the region that is nearer than z0, at least, and its mean depth there (meaningless if the share is 0).
struct MomentBlockers {
  double share, mean;
};
PENUMBRA_HD inline MomentBlockers blockers_of_moments(const Moments& b, double z0) {
  const ThreeDepths t = three_depths(b, z0);
  MomentBlockers found{0.0, 0.0};
  if (t.z2 < z0) found = {1.0 - t.weight0, (b[0] - t.weight0 * z0) / (1.0 - t.weight0)};
  else if (t.z1 < z0) found = {t.weight1, t.z1};
  found.share = found.share > 0.0 ? (found.share < 1.0 ? found.share : 1.0) : 0.0;  // NaN: 0
  return found;
}

/// Write the mean depth of what blocks into tile.blocker, and from it tile.visibility; a lane is a receiver.
void find_blockers(const LightView& view, const MomentTable& table, double bias, Tile& tile);
void filter(const LightView& view, const MomentTable& table, double bias, float scale, Tile& tile);

}  // namespace penumbra::moment_shadows
