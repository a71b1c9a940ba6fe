// What a ball of the covering wastes while it grows.
#pragma once

#include <algorithm>
#include <array>

#include "scenes/fit/solid_rows.h"

namespace penumbra {

/// Outside volume of balls about one centre over their radius, linear between samples; beyond the last one nothing more
/// is inside.
class Growth {
 public:
  Growth() = default;
  Growth(const SolidRows& rows, const dvec3& centre, double reach) : step_(reach / samples) {
    for (int i = 0; i <= samples; ++i) outside_[i] = rows.outside_volume(centre, step_ * i);
    inside_ = ball(reach) - outside_[samples];
  }
  double operator()(double radius) const {
    const double at = radius / step_;
    const int i = int(std::min(at, double(samples)));
    if (i == samples) return ball(radius) - inside_;
    return outside_[i] + (at - i) * (outside_[i + 1] - outside_[i]);
  }

 private:
  static double ball(double radius) { return 4.0 / 3.0 * pi * radius * radius * radius; }
  static constexpr int samples = 32;
  double step_ = 1.0, inside_ = 0.0;
  std::array<double, samples + 1> outside_{};
};

}  // namespace penumbra
