#include "techniques/ray_traced_denoised/ratio_filter.h"

namespace penumbra::ray_traced_denoised {
namespace {

struct Means {
  float seen, all;
};

/// Over pixel i and those that lie `step` apart, up to `before` and `after` of them on its sides.
Means box_mean(const Sums& in, std::size_t i, std::size_t step, float half, int before, int after) {
  float seen = in.seen[i], all = in.all[i], weights = 1.0f;
  for (int k = 1; float(k) < half + 1.0f; ++k) {
    const float weight = box_weight(half, k);
    const std::size_t far = std::size_t(k) * step;
    if (k <= after) seen += weight * in.seen[i + far], all += weight * in.all[i + far], weights += weight;
    if (k <= before) seen += weight * in.seen[i - far], all += weight * in.all[i - far], weights += weight;
  }
  return {seen / weights, all / weights};
}

}  // namespace

void filter_row(const SurfaceMap& map, const Plane& extent, float most, const Sums& in, int y, Sums& out) {
  const auto width = std::size_t(map.width);
  for (std::size_t i = std::size_t(y) * width; i < std::size_t(y + 1) * width; ++i) {
    const Means mean = box_mean(in, i, 1, half_width(extent[i], map.across[i], most), map.left[i], map.right[i]);
    out.seen[i] = mean.seen, out.all[i] = mean.all;
  }
}

void filter_columns(const SurfaceMap& map, const Plane& extent, float most, const Sums& in, int y, Plane& share) {
  const auto width = std::size_t(map.width);
  for (std::size_t i = std::size_t(y) * width; i < std::size_t(y + 1) * width; ++i) {
    const Means mean = box_mean(in, i, width, half_width(extent[i], map.along[i], most), map.up[i], map.down[i]);
    share[i] = visible_share(mean.seen, mean.all);
  }
}

}  // namespace penumbra::ray_traced_denoised
