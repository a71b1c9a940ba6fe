#include "techniques/bases/shadow_map/samples.h"

#include <algorithm>
#include <cmath>
#include <random>

namespace penumbra::shadow_map {
namespace {

float unit(std::mt19937& random) {
  return float(random() >> 8) * 0x1p-24f;
}

std::vector<int> permutation(int n, std::mt19937& random) {
  std::vector<int> order(n);
  for (int k = 0; k < n; ++k) order[k] = k;
  for (int k = n - 1; k > 0; --k) std::swap(order[k], order[random() % unsigned(k + 1)]);
  return order;
}

}  // namespace

std::vector<vec2> multi_jittered(int q, unsigned seed) {
  std::mt19937 random(seed);
  // Canonical: cell (i, j) holds the point of column i q + j and row j q + i. The same shuffle for all rows of cells
  // moves whole columns of sub-cells within a column of cells, and keeps both properties (Kensler 2013, section 2).
  const std::vector<int> columns = permutation(q, random), rows = permutation(q, random);
  std::vector<vec2> points;
  const float m = float(q * q);
  for (int j = 0; j < q; ++j)
    for (int i = 0; i < q; ++i) {
      const float x = (float(i * q + columns[j]) + unit(random)) / m, y = (float(j * q + rows[i]) + unit(random)) / m;
      points.push_back(glm::min(vec2(x, y), vec2(0x1.fffffep-1f)));
    }
  return points;
}

SampleImage make_sample_image(unsigned seed) {
  SampleImage image;
  for (int variant = 0; variant < SampleImage::variants; ++variant)
    for (const int q : {1, 2, 4}) {
      const auto points = multi_jittered(q, seed + 31u * unsigned(variant) + 1009u * unsigned(q));
      std::copy(points.begin(), points.end(), image.position[variant].begin() + (q * q - 1) / 3);
    }
  return image;
}

std::vector<vec2> poisson_disc(int count, unsigned seed) {
  std::mt19937 random(seed);
  std::vector<vec2> points;
  while (int(points.size()) < count) {
    vec2 best(0.0f);
    float best_distance = -1.0f;
    for (int k = 0; k < 16 * int(points.size() + 1); ++k) {
      vec2 p;
      do {
        const float y = unit(random);  // two draws in one argument list would be in the compiler's order
        p = 2.0f * vec2(unit(random), y) - 1.0f;
      } while (glm::dot(p, p) > 1.0f);
      float nearest = 1e9f;
      for (const vec2& other : points) nearest = std::min(nearest, glm::dot(p - other, p - other));
      if (nearest > best_distance) best_distance = nearest, best = p;
    }
    points.push_back(best);
  }
  return points;
}

std::vector<vec2> vogel_disc(int count) {
  std::vector<vec2> points;
  const double golden = pi * (3.0 - std::sqrt(5.0));
  for (int k = 0; k < count; ++k) {
    const double r = std::sqrt((k + 0.5) / count);
    points.emplace_back(r * std::cos(k * golden), r * std::sin(k * golden));
  }
  return points;
}

std::vector<vec2> lattice_square(int count) {
  std::vector<vec2> points;
  const double plastic = 1.32471795724474602596;
  for (int k = 0; k < count; ++k) {
    const double x = 0.5 + k / plastic, y = 0.5 + k / (plastic * plastic);
    points.emplace_back(x - std::floor(x), y - std::floor(y));
  }
  return points;
}

}  // namespace penumbra::shadow_map
