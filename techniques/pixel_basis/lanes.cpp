// Scene data rearranged for the vectorised loops.
#include <algorithm>
#include <cmath>

#include "techniques/pixel_basis/kernel.h"

namespace penumbra::pixel_basis {

void LightEnergy::assign(const CubeLight& light) {
  for (int c = 0; c < 3; ++c) {
    channel[c].clear();
    for (int t = 0; t < light.size(); ++t)
      channel[c].push_back(float(double(light.radiance[t][c]) * double(light.solid_angle[t]) / pi));
  }
}

void NormalWeights::assign(const LightEnergy& light, const LineCones& cones, vec3 unit_normal) {
  normal = unit_normal;
  active = 0;
  const std::size_t texels = light.channel[0].size(), lines = texels / texels_per_line;
  line.assign(lines, vec3(0.0f));
  std::vector<char> above(lines, 0);
  for (int c = 0; c < 3; ++c) {
    texel[c].assign(texels, 0.0f);
    word[c].assign(texels / 32, 0.0f);
    std::vector<double> words(texels / 32, 0.0), sums(lines, 0.0);
    for (std::size_t t = 0; t < texels; ++t) {
      const vec3 w(cones.direction[0][t], cones.direction[1][t], cones.direction[2][t]);
      const float cosine = glm::dot(unit_normal, w);
      if (cosine <= 0.0f) continue;
      texel[c][t] = light.channel[c][t] * cosine;
      words[t / 32] += double(texel[c][t]);
      sums[t / texels_per_line] += double(texel[c][t]);
      above[t / texels_per_line] = 1;
    }
    for (std::size_t w = 0; w < words.size(); ++w) word[c][w] = float(words[w]);
    for (std::size_t k = 0; k < lines; ++k) line[k][c] = float(sums[k]);
  }
  for (std::size_t k = 0; k < lines; ++k) active |= std::uint64_t(above[k]) << k;
}

}  // namespace penumbra::pixel_basis
