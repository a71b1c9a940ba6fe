// Gaussian blur of the visibility image (Zhu et al. 2019, section 5.3): separable, sigma half the radius, renormalised
// where the image ends or a receiver shows nothing.
#pragma once

#include <cstdint>
#include <vector>

#include "scenes/math.h"

namespace penumbra::pcss {

constexpr int most_blur = 16;

/// Weights of offsets 0 to radius, of sum 1 over -radius to radius.
std::vector<float> gaussian(int radius);

/// Sums of weight * value and of weight under the kernel at place `at` of `length`, elements `step` apart from `first`
/// on. `weighted`: the values are such sums already.
template <class Values, class Kernel>
PENUMBRA_HD void blur_at(const Values& values, const Values& weights, const Kernel& kernel, int radius, bool weighted,
                         std::size_t first, std::size_t step, int at, int length, float& value, float& weight) {
  value = weight = 0.0f;
  const int low = at < radius ? -at : -radius, high = at + radius < length ? radius : length - 1 - at;
  for (int k = low; k <= high; ++k) {
    const std::size_t i = first + std::size_t(at + k) * step;
    const float own = kernel[unsigned(k < 0 ? -k : k)], w = own * weights[i];
    value += (weighted ? own : w) * values[i];
    weight += w;
  }
}

/// An image of visibility and one of 0 or 1, whether the receiver counts.
struct MaskedImage {
  int width = 0, height = 0;
  std::vector<float> value, weight;
};

/// Rows [begin, end) along x: sums of weight * value and of weight under the kernel.
void blur_rows(const MaskedImage& in, const std::vector<float>& kernel, int begin, int end, MaskedImage& out);

void blur_part(const MaskedImage& in, const std::vector<float>& kernel, int row, int begin, int end, MaskedImage& out);

/// Rows [begin, end) along y, divided by the weight; 1 where nothing counts.
void blur_columns(const MaskedImage& in, const std::vector<float>& kernel, int begin, int end, float* out);
void blur_column_part(const MaskedImage& in, const std::vector<float>& kernel, int row, int begin, int end, float* out);

}  // namespace penumbra::pcss
