// Gaussian blur of the visibility image (Zhu et al. 2019, section 5.3): separable, sigma half the radius, renormalised
// where the image ends or a receiver shows nothing.
#pragma once

#include <cstdint>
#include <vector>

namespace penumbra::pcss {

constexpr int most_blur = 16;

/// Weights of offsets 0 to radius, of sum 1 over -radius to radius.
std::vector<float> gaussian(int radius);

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
