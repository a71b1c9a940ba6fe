// Where one surface goes on from pixel to pixel.
//
// Neighbours p, q with normals m, n are linked if neither lies far off the other's tangent plane, as seen under the
// angle between plane and chord, and their normals are alike:
//   |dot(m, q - p)|, |dot(n, q - p)| <= sine |q - p|,   dot(m, n) >= cosine
// A filter follows links along rows and columns and ends at the first that is missing.
#pragma once

#include <cstdint>
#include <vector>

#include "scenes/receivers.h"

namespace penumbra::ray_traced_denoised {

/// Most links that are counted, pixels.
constexpr int longest_run = 255;

/// Of every pixel, in row order: how many links lead on from it to either side, and pixels per metre there (0 without
/// any link: no filter).
struct SurfaceMap {
  static constexpr std::size_t padding = 64;  ///< at the end, for whole vectors
  int width = 0, height = 0;
  std::vector<std::uint8_t> left, right, up, down;
  std::vector<float> across, along;  ///< density of rows, and of columns, 1/m

  std::size_t bytes() const { return left.size() * (4 + 2 * sizeof(float)); }
};

bool linked(const Receivers& receivers, int a, int b);

/// An image of one row is none: nothing is linked there.
void find_surfaces(const Receivers& receivers, SurfaceMap& map);

}  // namespace penumbra::ray_traced_denoised
