// Scene data rearranged for the vectorised loops.
#include <algorithm>
#include <cmath>

#include "techniques/pixel_basis/kernel.h"

namespace penumbra::pixel_basis {

void SphereLanes::assign(const SphereSet& set) {
  const std::size_t padded = (set.size() + 15) / 16 * 16;
  for (auto* lane : {&x, &y, &z, &radius}) lane->assign(padded, 0.0f);
  for (std::size_t i = 0; i < set.size(); ++i) {
    const Sphere& s = set.spheres[i];
    x[i] = s.centre.x, y[i] = s.centre.y, z[i] = s.centre.z, radius[i] = s.radius;
  }
}

void LightLanes::assign(const CubeLight& light) {
  n = light.n;
  for (int c = 0; c < 3; ++c) {
    direction[c].resize(light.directions.size());
    energy[c].resize(light.directions.size());
    for (int t = 0; t < light.size(); ++t) {
      direction[c][t] = light.directions[t][c];
      energy[c][t] = float(double(light.radiance[t][c]) * double(light.solid_angle[t]) / pi);
    }
  }
  line_axis.clear(), line_sine.clear(), line_cosine.clear();
  for (int first = 0; first < light.size(); first += texels_per_line) {
    vec3 axis(0.0f);
    float cosine = 1.0f;
    for (int t = first; t < first + texels_per_line; ++t) axis += light.directions[t];
    axis = glm::normalize(axis);
    for (int t = first; t < first + texels_per_line; ++t)
      cosine = std::min(cosine, glm::dot(axis, light.directions[t]));
    cosine = std::max(-1.0f, cosine - 1e-5f);
    line_axis.push_back(axis);
    line_cosine.push_back(cosine);
    line_sine.push_back(std::sqrt(1.0f - cosine * cosine));
  }
}

void NormalWeights::assign(const LightLanes& light, vec3 unit_normal) {
  normal = unit_normal;
  active = 0;
  const std::size_t texels = light.energy[0].size(), lines = texels / texels_per_line;
  line.assign(lines, vec3(0.0f));
  std::vector<char> above(lines, 0);
  for (int c = 0; c < 3; ++c) {
    texel[c].assign(texels, 0.0f);
    word[c].assign(texels / 32, 0.0f);
    std::vector<double> words(texels / 32, 0.0), sums(lines, 0.0);
    for (std::size_t t = 0; t < texels; ++t) {
      const vec3 w(light.direction[0][t], light.direction[1][t], light.direction[2][t]);
      const float cosine = glm::dot(unit_normal, w);
      if (cosine <= 0.0f) continue;
      texel[c][t] = light.energy[c][t] * cosine;
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
