// The mask of masked_mean.h in words of bits, which hold a row of a window each.
//
// Within a row a surface spreads from the diagonals outwards, and within the diagonals from the row before: links
// between neighbours, as bits, make either a few operations for a whole row. So a window costs its rows, not its
// pixels.
#pragma once

#include <limits>

#include "techniques/visibility_filter/masked_mean.h"

namespace penumbra::visibility_filter {

// Not <bit>'s: in device code nvcc 13.0 makes constants of std::popcount, std::bit_width, std::countl_zero and
// std::countr_zero of 64 bits.
PENUMBRA_HD inline int bits_in(std::uint64_t word) {
  return __builtin_popcountll(word);
}
/// Numbers of the highest and the lowest bit that is set; one is.
PENUMBRA_HD inline int highest_bit(std::uint64_t word) {
  return 63 - __builtin_clzll(word);
}
PENUMBRA_HD inline int lowest_bit(std::uint64_t word) {
  return highest_bit(word & (0 - word));
}
PENUMBRA_HD constexpr std::uint64_t bit_at(int i) {
  return std::uint64_t(1) << i;
}
/// The lowest `count` bits, less than 64.
PENUMBRA_HD constexpr std::uint64_t ones(int count) {
  return bit_at(count) - 1;
}

/// The bits that links let `seeds` at bits `left` and `right` spread to: leftwards from the one, rightwards from the
/// other. Bit i of `links` joins bits i and i + 1.
PENUMBRA_HD inline std::uint64_t spread_out(std::uint64_t seeds, std::uint64_t links, int left, int right) {
  // A sum carries through a run of links to the first that is missing.
  std::uint64_t row = seeds | (links ^ (links + (seeds & bit_at(right))));
  if ((seeds & bit_at(left)) == 0) return row;
  const std::uint64_t missing = ~links & ones(left);
  return row | (ones(left) & ~ones(highest_bit(missing << 1 | 1)));
}

/// Of a pixel to that neighbour; the last from the right one of two.
struct Links {
  bool right, down, down_right, down_left;
};

/// The links of a pixel, from the distances of all to the lamp, in row order.
template <class Floats>
PENUMBRA_HD Links links_of(const Floats& depth, int width, int height, int x, int y, float epsilon) {
  const std::size_t i = std::size_t(y) * std::size_t(width) + std::size_t(x), below = i + std::size_t(width);
  const bool right = x + 1 < width, down = y + 1 < height;
  const float own = depth[i];
  return {right && joined(own, depth[i + 1], epsilon), down && joined(own, depth[below], epsilon),
          right && down && joined(own, depth[below + 1], epsilon),
          right && down && joined(depth[i + 1], depth[below], epsilon)};
}

/// Images of such bits, wherever the words lie (`Words` is an array of them).
template <class Words>
struct SurfaceRows {
  static constexpr int margin = 64;  ///< empty columns left of the image, so that windows may reach over its edge

  int width = 0, height = 0;
  int stride = 0;  ///< words of a row: the margin's, the image's, and an empty one
  Words open{}, seen{};
  Words right{}, down{}, down_right{}, down_left{};  ///< links
  Words joined{};                                    ///< all four of them
  Words near_dark{}, near_lit{}, near_joined{};      ///< within the widest window's columns
  Words mixed{};                                     ///< within the widest window there are both light and shadow
  Words whole{};                                     ///< and nothing of it lies on another surface, or outside

  static int stride_for(int wide) { return (wide + margin + 63) / 64 + 1; }
  std::size_t words() const { return std::size_t(stride) * std::size_t(height); }

  PENUMBRA_HD std::size_t pixel(int x, int y) const { return std::size_t(y) * std::size_t(width) + std::size_t(x); }
  PENUMBRA_HD std::size_t word(int w, int y) const { return std::size_t(y) * std::size_t(stride) + std::size_t(w); }
  PENUMBRA_HD bool bit(const Words& plane, int x, int y) const {
    return (plane[word((x + margin) / 64, y)] >> ((x + margin) % 64) & 1) != 0;
  }
  /// Where the 64 columns from x on lie in every row; x lies from -margin to the image's last.
  struct Columns {
    unsigned word, shift;
  };
  PENUMBRA_HD static Columns columns(int x) { return {unsigned(x + margin) / 64, unsigned(x + margin) % 64}; }
  /// 64 pixels of row y.
  PENUMBRA_HD std::uint64_t at(const Words& plane, Columns from, int y) const {
    const std::size_t w = word(int(from.word), y);
    return plane[w] >> from.shift | plane[w + 1] << 1 << (63 - from.shift);
  }
  PENUMBRA_HD std::uint64_t at(const Words& plane, int x, int y) const { return at(plane, columns(x), y); }

  // Words 1 to stride - 2 of a row hold the image.

  /// Sets near_dark, near_lit and near_joined for windows of up to 2 r + 1.
  PENUMBRA_HD void look_across(int w, int y, int r) const {
    std::uint64_t dark = 0, lit = 0, all = ~std::uint64_t(0);
    for (int x = 64 * w - margin - r; x <= 64 * w - margin + r; ++x) {
      const std::uint64_t there = at(seen, x, y), light = at(open, x, y);
      dark |= there & ~light, lit |= there & light, all &= at(joined, x, y);
    }
    near_dark[word(w, y)] = dark, near_lit[word(w, y)] = lit, near_joined[word(w, y)] = all;
  }
  /// Then sets mixed and whole.
  PENUMBRA_HD void look_along(int w, int y, int r) const {
    const bool inside = y >= r && y + r < height;
    std::uint64_t dark = 0, lit = 0, all = inside ? ~std::uint64_t(0) : 0;
    const int top = y > r ? y - r : 0, bottom = y + r < height ? y + r : height - 1;
    for (int v = top; v <= bottom; ++v) {
      dark |= near_dark[word(w, v)], lit |= near_lit[word(w, v)];
      all &= near_joined[word(w, v)];
    }
    mixed[word(w, y)] = dark & lit, whole[word(w, y)] = all;
  }

  /// Calls use(dy, word) for rows of the mask, bit i of which is the pixel at x - r + i, from the middle outwards,
  /// until enough(k), asked before the rows k above and below.
  template <class Use, class Enough>
  PENUMBRA_HD void for_rows(int x, int y, int r, const Use& use, const Enough& enough) const {
    const std::uint64_t window = ones(2 * r + 1);
    const Columns from = columns(x - r);
    const bool all = bit(whole, x, y);
    std::uint64_t above = all ? window : spread_out(bit_at(r), at(right, from, y) & window, r, r) & window;
    std::uint64_t below = above;
    use(0, above);
    for (int k = 1; k <= r && (above | below) != 0 && !enough(k); ++k) {
      if (!all) above = next_row(above, from, y, r, -1, k), below = next_row(below, from, y, r, 1, k);
      if (above != 0) use(-k, above);
      if (below != 0) use(k, below);
    }
  }

  PENUMBRA_HD Counted count(int x, int y, int r) const {
    Counted counted;
    const Columns from = columns(x - r);
    for_rows(
        x, y, r,
        [&](int dy, std::uint64_t row) {
          counted.all += bits_in(row);
          counted.open += bits_in(row & at(open, from, y + dy));
        },
        [](int) { return false; });
    return counted;
  }

  /// As count(), of the whole window (Chen et al. 2016), pixels that show nothing left out.
  PENUMBRA_HD Counted count_all(int x, int y, int r) const {
    Counted counted;
    const Columns from = columns(x - r);
    const int top = y > r ? y - r : 0, bottom = y + r < height ? y + r : height - 1;
    for (int v = top; v <= bottom; ++v) {
      const std::uint64_t row = at(seen, from, v) & ones(2 * r + 1);
      counted.all += bits_in(row);
      counted.open += bits_in(row & at(open, from, v));
    }
    return counted;
  }

  /// As visibility_filter::borrowed_caster(), of these casters.
  template <class Floats>
  PENUMBRA_HD float borrowed_caster(const Floats& caster, int x, int y, int r) const {
    const Columns from = columns(x - r);
    int least = 2 * widest * widest, nearest_x = 0, nearest_y = 0;
    const auto look_at = [&](int dx, int dy) {
      const int distance = dx * dx + dy * dy;
      const bool first = dy < nearest_y || (dy == nearest_y && dx < nearest_x);  // rows do not come in their order
      if (distance < least || (distance == least && first)) least = distance, nearest_x = dx, nearest_y = dy;
    };
    for_rows(
        x, y, r,
        [&](int dy, std::uint64_t row) {
          const std::uint64_t dark = row & ~at(open, from, y + dy);
          if (const std::uint64_t left_half = dark & ones(r + 1)) look_at(highest_bit(left_half) - r, dy);
          if (const std::uint64_t right_half = dark >> r) look_at(lowest_bit(right_half), dy);
        },
        [&](int k) { return k * k > least; });
    if (least == 2 * widest * widest) return std::numeric_limits<float>::infinity();
    return caster[pixel(x + nearest_x, y + nearest_y)];
  }

 private:
  /// Row k above (way -1) or below (1): from the row before, inside the diagonals straight and along them aslant; then
  /// outwards within the row. 0 from the first row on that nothing reaches.
  PENUMBRA_HD std::uint64_t next_row(std::uint64_t row, Columns from, int y, int r, int way, int k) const {
    const int v = y + way * k, between = way < 0 ? v : v - 1;  // the upper row of two holds their links
    if (row == 0 || v < 0 || v >= height) return 0;
    const Words &to_right = way < 0 ? down_left : down_right, &to_left = way < 0 ? down_right : down_left;
    const std::uint64_t inner = ones(2 * k - 1) << (r - k + 1);
    const std::uint64_t straight = row & inner & at(down, from, between);
    const std::uint64_t right_end = (row & at(to_right, from, between)) << 1 & bit_at(r + k);
    const std::uint64_t left_end = row >> 1 & at(to_left, from, between) & bit_at(r - k);
    return spread_out(straight | right_end | left_end, at(right, from, v), r - k, r + k) & ones(2 * r + 1);
  }
};

}  // namespace penumbra::visibility_filter
