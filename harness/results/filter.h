// Separable filtering of single-channel images, borders replicated.
#pragma once

#include <vector>

namespace penumbra {

using Kernel = std::vector<double>;  ///< odd length, centre in the middle

/// exp(-x^2 / (2 sigma^2)), normalised to sum 1.
Kernel gaussian_kernel(double sigma, int radius);

/// Convolution (correlation) with horizontal x vertical; sums in double.
std::vector<float> filter(const std::vector<float>& image, int width, int height, const Kernel& horizontal,
                          const Kernel& vertical);

}  // namespace penumbra
