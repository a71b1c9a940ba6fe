// Sample positions within a square, made once.
#pragma once

#include <array>
#include <vector>

#include "scenes/math.h"

namespace penumbra::shadow_map {

/// Multi-jittered positions (Chiu et al. 1994, shuffled as in Kensler 2013) in [0, 1)^2: 8 variants of 1, 4 and 16, the
/// 21 x 8 image of Zhu et al. 2019, section 3.1.
struct SampleImage {
  static constexpr int variants = 8, columns = 21;
  std::array<std::array<vec2, columns>, variants> position;

  /// First column and number of samples for a square of `edge` texels: 1 up to 2, 4 at 4, 16 from 8 on.
  PENUMBRA_HD static constexpr int count(int edge) { return edge >= 8 ? 16 : edge >= 4 ? 4 : 1; }
  static int first(int edge) { return (count(edge) - 1) / 3; }
};
SampleImage make_sample_image(unsigned seed = 1);

/// m = q^2 multi-jittered points: one in each cell of a q x q grid, one in each of m rows and m columns.
std::vector<vec2> multi_jittered(int q, unsigned seed);

/// `count` points of the unit disc: best of candidates, each as far as can be from those before (Mitchell 1991), so
/// that every prefix is spread too.
std::vector<vec2> poisson_disc(int count, unsigned seed = 1);

/// `count` points of the unit disc on Vogel's spiral: equal areas, golden angle.
std::vector<vec2> vogel_disc(int count);

/// `count` points of the unit square, in the plastic-number lattice (Roberts 2018).
std::vector<vec2> lattice_square(int count);

}  // namespace penumbra::shadow_map
