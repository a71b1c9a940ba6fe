#include "techniques/pcss/blur.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace penumbra::pcss {

std::vector<float> gaussian(int radius) {
  const double sigma = 0.5 * radius;
  std::vector<double> weights;
  double sum = 0.0;
  for (int k = 0; k <= radius; ++k) {
    weights.push_back(radius > 0 ? std::exp(-0.5 * k * k / (sigma * sigma)) : 1.0);
    sum += (k ? 2.0 : 1.0) * weights.back();
  }
  std::vector<float> kernel;
  kernel.reserve(weights.size());
  for (const double w : weights) kernel.push_back(float(w / sum));
  return kernel;
}

void blur_part(const MaskedImage& in, const std::vector<float>& kernel, int row, int begin, int end, MaskedImage& out) {
  const int radius = int(kernel.size()) - 1;
  const std::size_t first = std::size_t(row) * in.width;
  for (int x = begin; x < end; ++x) {
    float value = 0.0f, weight = 0.0f;
    for (int k = std::max(-radius, -x); k <= std::min(radius, in.width - 1 - x); ++k) {
      const float w = kernel[std::abs(k)] * in.weight[first + x + k];
      value += w * in.value[first + x + k];
      weight += w;
    }
    out.value[first + x] = value, out.weight[first + x] = weight;
  }
}

void blur_rows(const MaskedImage& in, const std::vector<float>& kernel, int begin, int end, MaskedImage& out) {
  for (int y = begin; y < end; ++y) blur_part(in, kernel, y, 0, in.width, out);
}

void blur_column_part(const MaskedImage& in, const std::vector<float>& kernel, int row, int begin, int end,
                      float* out) {
  const int radius = int(kernel.size()) - 1;
  for (int x = begin; x < end; ++x) {
    float value = 0.0f, weight = 0.0f;
    for (int k = std::max(-radius, -row); k <= std::min(radius, in.height - 1 - row); ++k) {
      const std::size_t at = std::size_t(row + k) * in.width + x;
      value += kernel[std::abs(k)] * in.value[at];
      weight += kernel[std::abs(k)] * in.weight[at];
    }
    out[std::size_t(row) * in.width + x] = weight > 0.0f ? value / weight : 1.0f;
  }
}

void blur_columns(const MaskedImage& in, const std::vector<float>& kernel, int begin, int end, float* out) {
  for (int y = begin; y < end; ++y) blur_column_part(in, kernel, y, 0, in.width, out);
}

}  // namespace penumbra::pcss
