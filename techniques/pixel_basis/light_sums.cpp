#include "techniques/pixel_basis/kernel.h"

namespace penumbra::pixel_basis {
namespace {

struct Sum {
  double value[16] = {};
  void add(const LightSums::Nine& nine) {
    for (int k = 0; k < 16; ++k) value[k] += double(nine.value[k]);
  }
  LightSums::Nine rounded() const {
    LightSums::Nine nine;
    for (int k = 0; k < 16; ++k) nine.value[k] = float(value[k]);
    return nine;
  }
};

/// Running sums within groups of `size`: those up to each element, those from each on, and a 0.
void sum_groups(const std::vector<LightSums::Nine>& all, std::size_t size, std::vector<LightSums::Nine>& up_to,
                std::vector<LightSums::Nine>& from) {
  up_to.assign(all.size() + 1, {}), from = up_to;
  for (std::size_t first = 0; first < all.size(); first += size) {
    Sum left, right;
    for (std::size_t k = 0, last = first + size - 1; k < size; ++k) {
      left.add(all[first + k]), up_to[first + k] = left.rounded();
      right.add(all[last - k]), from[last - k] = right.rounded();
    }
  }
}

/// The whole of each group.
std::vector<LightSums::Nine> wholes(const std::vector<LightSums::Nine>& up_to, std::size_t size) {
  std::vector<LightSums::Nine> out;
  for (std::size_t last = size - 1; last + 1 < up_to.size(); last += size) out.push_back(up_to[last]);
  return out;
}

}  // namespace

void LightSums::assign(const CubeLight& light) {
  texel.assign(std::size_t(light.size()), {});
  for (int t = 0; t < light.size(); ++t)
    for (int c = 0; c < 3; ++c)
      for (int axis = 0; axis < 3; ++axis)
        texel[t].value[c * 4 + axis] =
            float(double(light.radiance[t][c]) * double(light.solid_angle[t]) / pi * double(light.directions[t][axis]));
  sum_groups(texel, 32, up_to, from);
  sum_groups(wholes(up_to, 32), words_per_line, words_up_to, words_from);
  line = wholes(words_up_to, words_per_line);
}

}  // namespace penumbra::pixel_basis
