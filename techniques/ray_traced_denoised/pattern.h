// Which points of the light a pixel asks (interleaved sampling, Keller & Heidrich 2001): those of an 8 x 8 block of
// pixels are together one set that covers the light evenly, and so are, more coarsely, those of every 4 x 4 and 2 x 2
// of them. A filter over the image then adds up different points, not the same ones again.
//
// Point i is that of the (0, 2)-sequence (Sobol 1967): every 2^m from a multiple of 2^m on lie one in each of 2^m equal
// boxes, of whatever shape. A pixel takes k in a row; pixels are numbered along a Z-curve, so that windows of 2 x 2
// pixels, aligned or not, hold all four remainders of the number by 4, those of 4 x 4 all sixteen by 16.
#pragma once

#include <cstdint>
#include <vector>

#include "scenes/math.h"

namespace penumbra::ray_traced_denoised {

constexpr int pattern_edge = 8;                            ///< pixels
constexpr int pattern_size = pattern_edge * pattern_edge;  ///< pixels

/// Number of a pixel in its block: bits of x and y in turn.
inline int place_in_pattern(int x, int y) {
  int place = 0;
  for (int bit = 0; bit < 3; ++bit) place |= (x >> bit & 1) << (2 * bit) | (y >> bit & 1) << (2 * bit + 1);
  return place;
}

/// Points in [0, 1)^2, digits scrambled by the seed: `rays` for each place in the pattern, one place after the other.
std::vector<vec2> pattern_points(int rays, std::uint64_t seed);

}  // namespace penumbra::ray_traced_denoised
