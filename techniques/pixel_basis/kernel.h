// The vectorised inner loops of pixel-basis, compiled for every instruction set and dispatched at run time.
#pragma once

#include <cstdint>
#include <vector>

#include "techniques/bases/blocked.h"
#include "techniques/technique.h"

namespace penumbra::pixel_basis {

/// Sums of light by where it comes from. The cosine is linear in the normal wherever it is positive:
///   sum over texels of L (N . w) dw / pi = N . (sum of L w dw / pi),
/// so nine numbers, three channels by three axes, serve receivers of any normal.
struct LightSums {
  /// L w dw / pi by channel, an axis in each of the first three of its four places.
  struct alignas(64) Nine {
    float value[16] = {};
  };
  /// Of each word's texels up to this one, and from this one on; of each line's words alike. The last element is 0.
  std::vector<Nine> up_to, from, words_up_to, words_from;
  std::vector<Nine> texel, line;

  void assign(const CubeLight& light);
  std::size_t bytes() const {
    return (up_to.size() + from.size() + words_up_to.size() + words_from.size() + texel.size() + line.size()) *
           sizeof(Nine);
  }
};

struct Job {
  BlockedJob blocked;
  const LightSums* light;
};

/// Shades the receivers that are [begin, end) in the job's order.
void shade(const Job& job, int begin, int end, vec3* radiance);

}  // namespace penumbra::pixel_basis
