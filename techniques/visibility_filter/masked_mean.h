// The filter: a mean of binary visibility over those pixels of a window that lie on one surface with its centre (Yang
// et al. 2019, section 2.4).
//
// The mask grows from the centre by rings. A pixel of ring k at offset (dx, dy) asks its nearest pixel of ring k - 1,
// the offset clamped to [-(k - 1), k - 1]: it lies on the surface if that one does and their distances to the lamp
// differ by less than epsilon. Pixels that show nothing lie on none.
#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include "scenes/math.h"

namespace penumbra::visibility_filter {

/// What is known of each pixel of an image, in row order.
struct PixelMap {
  int width = 0, height = 0;
  std::vector<std::uint8_t> open;  ///< 1: the lamp's centre is seen from there
  std::vector<float> depth;        ///< distance to the lamp's centre, m; NaN where nothing is seen
  std::vector<float> caster;       ///< distance to the nearest caster, m; infinity where there is none

  std::size_t index(int x, int y) const { return std::size_t(y) * std::size_t(width) + std::size_t(x); }

  void resize(int wide, int high) {
    width = wide, height = high;
    const std::size_t n = std::size_t(wide) * std::size_t(high);
    open.resize(n), depth.resize(n), caster.resize(n);
  }
};

/// Widest window that the filters take, pixels.
constexpr int widest = 63;

/// Pixels of a window that count, and how many of them see the lamp.
struct Counted {
  int all = 0, open = 0;
  PENUMBRA_HD float mean() const { return all > 0 ? float(open) / float(all) : 1.0f; }
  friend bool operator==(const Counted&, const Counted&) = default;
};

/// Do neighbours at distances a and b from the lamp lie on one surface?
PENUMBRA_HD inline bool joined(float a, float b, float epsilon) {
  return std::fabs(a - b) < epsilon;
}

/// The ring loop as it is described: whether pixels of the window of 2 r + 1 about (x, y), in row order, lie on its
/// surface.
void find_surface(const PixelMap& map, int x, int y, int r, float epsilon, std::vector<std::uint8_t>& same);

Counted count_surface(const PixelMap& map, int x, int y, int r, const std::vector<std::uint8_t>& same);

/// Distance from the lit pixel at (x, y) to the caster of the nearest shadowed pixel of its surface within r pixels; of
/// equally near ones the first in row order. Infinity if there is none.
float borrowed_caster(const PixelMap& map, int x, int y, int r, const std::vector<std::uint8_t>& same);

}  // namespace penumbra::visibility_filter
