#include "techniques/moment_shadows/moments.h"

#include <tbb/parallel_for.h>

#include <algorithm>

namespace penumbra::moment_shadows {

void MomentTable::build(const ShadowMap& map, float far) {
  edge_ = map.resolution();
  near_ = double(map.view.near);
  // Empty texels lie a quarter behind the farthest receiver: the answer is unstable where a receiver's depth is also
  // one of the region's.
  scale_ = double(far) > near_ ? 0.8 / (double(far) - near_) : 1.0;
  const std::size_t stride = std::size_t(edge_) + 1;
  for (auto& sums : sums_) sums.resize(stride * stride), std::fill_n(sums.begin(), stride, 0.0);
  tbb::parallel_for(0, edge_, [&](int y) {  // along rows
    Moments sum{};
    for (auto& sums : sums_) sums[(std::size_t(y) + 1) * stride] = 0.0;
    for (int x = 0; x < edge_; ++x) {
      const double z = std::clamp(normalised(map.at(x, y)), 0.0, 1.0);
      double power = 1.0;
      for (std::size_t j = 0; j < 4; ++j) {
        power *= z;
        sum[j] += power;
        sums_[j][(std::size_t(y) + 1) * stride + x + 1] = sum[j];
      }
    }
  });
  constexpr int strip = 64;  // columns that a core adds up together
  tbb::parallel_for(0, 4 * ((edge_ + strip - 1) / strip), [&](int k) {
    auto& sums = sums_[std::size_t(k % 4)];
    const int begin = k / 4 * strip, end = std::min(edge_, begin + strip);
    for (std::size_t y = 1; y < std::size_t(edge_); ++y)
      for (int x = begin + 1; x <= end; ++x) sums[(y + 1) * stride + x] += sums[y * stride + x];
  });
}

Moments MomentTable::mean(const Texels& t) const {
  const auto cut = [&](int k) { return std::size_t(std::clamp(k, 0, edge_)); };
  const std::size_t stride = std::size_t(edge_) + 1;
  const std::size_t l = cut(t.left), r = cut(t.right), top = cut(t.top) * stride, bottom = cut(t.bottom) * stride;
  const double count = t.count(), outside = count - double((r - l) * (cut(t.bottom) - cut(t.top)));
  Moments b{};
  for (std::size_t j = 0; j < 4; ++j) {
    const auto& s = sums_[j];
    b[j] = ((s[bottom + r] - s[bottom + l]) - (s[top + r] - s[top + l]) + outside) / count;
  }
  return b;
}

}  // namespace penumbra::moment_shadows
