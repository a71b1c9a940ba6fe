// The filter of the two sums (Heitz, Hill & McGuire 2018): S, what arrives along the rays that are not blocked, and U,
// what all of them would bring, are smoothed by one and the same kernel; their ratio is the share that is visible.
//
// The kernel is a box, first along rows and then along columns, as wide as part of the penumbra and no wider than the
// surface goes on:
//   b = min(most, extent x pixels per metre)        full width, pixels
//   weight of the k-th neighbour = clamp((b + 1) / 2 - k, 0, 1)
// A box of 4 or 8 pixels weighs all places of the pattern alike (pattern.h): its ends count half. One of up to a pixel
// leaves everything as it is.
#pragma once

#include <cmath>

#include "techniques/ray_traced_denoised/surface.h"

namespace penumbra::ray_traced_denoised {

/// A number per pixel in row order, with room for whole vectors and windows on either side.
class Plane {
 public:
  /// Zeros, or what was there if the size stays.
  void resize(std::size_t n) {
    if (values_.size() != n + 2 * margin) values_.assign(n + 2 * margin, 0.0f);
  }
  float* data() { return values_.data() + margin; }
  const float* data() const { return values_.data() + margin; }
  float& operator[](std::size_t i) { return values_[i + margin]; }
  float operator[](std::size_t i) const { return values_[i + margin]; }
  std::size_t bytes() const { return values_.size() * sizeof(float); }

 private:
  static constexpr std::size_t margin = 512;
  std::vector<float> values_;
};

/// S and U of one channel.
struct Sums {
  Plane seen, all;
};

/// Widest box, pixels.
constexpr int widest_box = 64;

/// What a box weighs: neighbours up to `half` pixels away, (b - 1) / 2, and the two at its ends in part.
PENUMBRA_HD inline float half_width(float extent, float density, float most) {
  const float b = extent * density < most ? extent * density : most;
  return b > 1.0f ? 0.5f * (b - 1.0f) : 0.0f;
}
PENUMBRA_HD inline float box_weight(float half, int k) {
  const float weight = half + 1.0f - float(k);
  return weight < 0.0f ? 0.0f : weight > 1.0f ? 1.0f : weight;
}

/// Part of the sums where nothing arrives counts as visible: what is unshadowed there is all there is to say.
PENUMBRA_HD inline float visible_share(float seen, float all) {
  return all > 0.0f ? seen / all : 1.0f;
}

/// Means of the sums over the row, of pixels [begin, end) of row y, in `out`. `extent`: full width of every pixel's
/// box, m.
void filter_row(const SurfaceMap& map, const Plane& extent, float most, const Sums& in, int y, Sums& out);
/// Means over the column, and their ratio.
void filter_columns(const SurfaceMap& map, const Plane& extent, float most, const Sums& in, int y, Plane& share);

/// The same on vectors.
namespace simd {
void filter_row(const SurfaceMap& map, const Plane& extent, float most, const Sums& in, int y, Sums& out);
void filter_columns(const SurfaceMap& map, const Plane& extent, float most, const Sums& in, int y, Plane& share);
}  // namespace simd

}  // namespace penumbra::ray_traced_denoised
