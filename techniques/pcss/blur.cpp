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
  const std::size_t first = std::size_t(row) * in.width;
  for (int x = begin; x < end; ++x)
    blur_at(in.value, in.weight, kernel, int(kernel.size()) - 1, false, first, 1, x, in.width, out.value[first + x],
            out.weight[first + x]);
}

void blur_rows(const MaskedImage& in, const std::vector<float>& kernel, int begin, int end, MaskedImage& out) {
  for (int y = begin; y < end; ++y) blur_part(in, kernel, y, 0, in.width, out);
}

void blur_column_part(const MaskedImage& in, const std::vector<float>& kernel, int row, int begin, int end,
                      float* out) {
  for (int x = begin; x < end; ++x) {
    float value, weight;
    blur_at(in.value, in.weight, kernel, int(kernel.size()) - 1, true, std::size_t(x), std::size_t(in.width), row,
            in.height, value, weight);
    out[std::size_t(row) * in.width + x] = weight > 0.0f ? value / weight : 1.0f;
  }
}

void blur_columns(const MaskedImage& in, const std::vector<float>& kernel, int begin, int end, float* out) {
  for (int y = begin; y < end; ++y) blur_column_part(in, kernel, y, 0, in.width, out);
}

}  // namespace penumbra::pcss
