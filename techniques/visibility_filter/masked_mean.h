// The filter: a mean of binary visibility over those pixels of a window that lie on one surface with its centre (Yang
// et al. 2019, section 2.4).
//
// The mask grows from the centre by rings. A pixel of ring k at offset (dx, dy) asks its nearest pixel of ring k - 1,
// the offset clamped to [-(k - 1), k - 1]: it lies on the surface if that one does and their distances to the lamp
// differ by less than epsilon. Pixels that show nothing lie on none.
#pragma once

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

/// The ring loop as it is described: whether pixels of the window of 2 r + 1 about (x, y), in row order, lie on its
/// surface.
void find_surface(const PixelMap& map, int x, int y, int r, float epsilon, std::vector<std::uint8_t>& same);

Counted count_surface(const PixelMap& map, int x, int y, int r, const std::vector<std::uint8_t>& same);

/// Distance from the lit pixel at (x, y) to the caster of the nearest shadowed pixel of its surface within r pixels; of
/// equally near ones the first in row order. Infinity if there is none.
float borrowed_caster(const PixelMap& map, int x, int y, int r, const std::vector<std::uint8_t>& same);

/// The same with words of bits, which hold a row of a window each. Within a row a surface spreads from the diagonals
/// outwards, and within the diagonals from the row before: links between neighbours, as bits, make either one or two
/// operations for a whole row. So a window costs its rows, not its pixels.
class SurfaceBits {
 public:
  /// Takes in a map. Pixels whose windows of up to 2 r + 1 are all lit or all dark are known from then on.
  void set(const PixelMap& map, float epsilon, int r);

  /// Do windows of up to 2 r + 1 about the pixel hold both?
  bool mixed(int x, int y) const { return bit(mixed_, x, y); }

  Counted count(int x, int y, int r) const;
  /// As count(), of the whole window (Chen et al. 2016), pixels that show nothing left out.
  Counted count_all(int x, int y, int r) const;
  float borrowed_caster(int x, int y, int r) const;

  std::size_t bytes() const { return 7 * open_.size() * sizeof(std::uint64_t); }

 private:
  using Rows = std::vector<std::uint64_t>;

  std::size_t word(int x, int y) const { return std::size_t(y) * std::size_t(stride_) + std::size_t(x + margin) / 64; }
  bool bit(const Rows& rows, int x, int y) const { return (rows[word(x, y)] >> ((x + margin) % 64) & 1) != 0; }
  void put(Rows& rows, int x, int y, bool value) const {
    rows[word(x, y)] |= std::uint64_t(value) << ((x + margin) % 64);
  }
  /// 64 pixels of row y from column x on, which may begin left of the image.
  std::uint64_t at(const Rows& rows, int x, int y) const;
  Rows spread(const Rows& rows, int r) const;
  /// Calls use(dy, word) for rows of the mask, bit i of which is the pixel at x - r + i; the middle one first.
  template <class Use>
  void for_rows(int x, int y, int r, const Use& use) const;

  static constexpr int margin = 64;  ///< empty columns left of the image, so that windows may reach over its edge
  const PixelMap* map_ = nullptr;
  int stride_ = 0;  ///< words of a row
  Rows open_, seen_, mixed_;
  Rows right_, down_, down_right_,
      down_left_;  ///< links: of a pixel to that neighbour; the last from the right one of two
};

}  // namespace penumbra::visibility_filter
