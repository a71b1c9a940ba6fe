#include "harness/results/filter.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

namespace penumbra {

Kernel gaussian_kernel(double sigma, int radius) {
  Kernel kernel;
  double sum = 0.0;
  for (int x = -radius; x <= radius; ++x) sum += kernel.emplace_back(std::exp(-0.5 * x * x / (sigma * sigma)));
  for (double& k : kernel) k /= sum;
  return kernel;
}

std::vector<float> filter(const std::vector<float>& image, int width, int height, const Kernel& horizontal,
                          const Kernel& vertical) {
  const int rx = int(horizontal.size()) / 2, ry = int(vertical.size()) / 2;
  std::vector<double> rows(image.size());
  tbb::parallel_for(0, height, [&](int y) {
    for (int x = 0; x < width; ++x) {
      double sum = 0.0;
      for (int k = -rx; k <= rx; ++k)
        sum += horizontal[k + rx] * double(image[std::size_t(y) * width + std::clamp(x + k, 0, width - 1)]);
      rows[std::size_t(y) * width + x] = sum;
    }
  });
  std::vector<float> out(image.size());
  tbb::parallel_for(0, height, [&](int y) {
    for (int x = 0; x < width; ++x) {
      double sum = 0.0;
      for (int k = -ry; k <= ry; ++k)
        sum += vertical[k + ry] * rows[std::size_t(std::clamp(y + k, 0, height - 1)) * width + x];
      out[std::size_t(y) * width + x] = float(sum);
    }
  });
  return out;
}

}  // namespace penumbra
