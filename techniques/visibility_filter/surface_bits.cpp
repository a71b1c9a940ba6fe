#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "techniques/bases/for_ranges.h"
#include "techniques/visibility_filter/masked_mean.h"

namespace penumbra::visibility_filter {
namespace {

constexpr std::uint64_t ones(int count) {
  return count >= 64 ? ~std::uint64_t(0) : (std::uint64_t(1) << count) - 1;
}

constexpr std::uint64_t bit_at(int i) {
  return std::uint64_t(1) << i;
}

/// The bits that links let `seeds` at bits `left` and `right` spread to: leftwards from the one, rightwards from the
/// other. Bit i of `links` joins bits i and i + 1.
std::uint64_t spread_out(std::uint64_t seeds, std::uint64_t links, int left, int right) {
  std::uint64_t row = seeds;
  if ((seeds & bit_at(right)) != 0) row |= ones(std::countr_one(links >> right) + 1) << right;
  if (left > 0 && (seeds & bit_at(left)) != 0) {
    const int run = std::countl_one(links << (64 - left));
    row |= ones(std::min(run, left)) << (left - std::min(run, left));
  }
  return row;
}

}  // namespace

void SurfaceBits::set(const PixelMap& map, float epsilon, int r) {
  map_ = &map;
  stride_ = (map.width + margin + 63) / 64 + 1;
  const std::size_t words = std::size_t(stride_) * std::size_t(map.height);
  for (Rows* rows : {&open_, &seen_, &right_, &down_, &down_right_, &down_left_}) rows->assign(words, 0);
  for_ranges(map.height, 8, [&](int begin, int end) {
    for (int y = begin; y < end; ++y) {
      const float* row = &map.depth[map.index(0, y)];
      const float* next = y + 1 < map.height ? row + map.width : nullptr;
      const auto joined = [&](float a, float b) { return std::fabs(a - b) < epsilon; };
      for (int x = 0; x < map.width; ++x) {
        const bool more = x + 1 < map.width;
        put(open_, x, y, map.open[map.index(x, y)] != 0);
        put(seen_, x, y, row[x] == row[x]);
        put(right_, x, y, more && joined(row[x], row[x + 1]));
        if (!next) continue;
        put(down_, x, y, joined(row[x], next[x]));
        put(down_right_, x, y, more && joined(row[x], next[x + 1]));
        put(down_left_, x, y, more && joined(row[x + 1], next[x]));
      }
    }
  });
  Rows dark(words), lit(words);
  for (std::size_t i = 0; i < words; ++i) dark[i] = seen_[i] & ~open_[i], lit[i] = seen_[i] & open_[i];
  dark = spread(dark, r), mixed_ = spread(lit, r);
  for (std::size_t i = 0; i < words; ++i) mixed_[i] &= dark[i];
}

/// Bits within r rows and columns of one that is set.
SurfaceBits::Rows SurfaceBits::spread(const Rows& rows, int r) const {
  Rows across(rows.size());
  for_ranges(map_->height, 8, [&](int begin, int end) {
    for (int y = begin; y < end; ++y)
      for (int w = 0; w < stride_; ++w) {
        const int x = 64 * w - margin;
        std::uint64_t all = 0;
        for (int dx = -r; dx <= r; ++dx) all |= at(rows, x + dx, y);
        across[std::size_t(y) * std::size_t(stride_) + std::size_t(w)] = all;
      }
  });
  Rows both(rows.size());
  for_ranges(map_->height, 8, [&](int begin, int end) {
    for (int y = begin; y < end; ++y)
      for (int near = std::max(0, y - r); near <= std::min(map_->height - 1, y + r); ++near)
        for (int w = 0; w < stride_; ++w)
          both[std::size_t(y) * std::size_t(stride_) + std::size_t(w)] |=
              across[std::size_t(near) * std::size_t(stride_) + std::size_t(w)];
  });
  return both;
}

std::uint64_t SurfaceBits::at(const Rows& rows, int x, int y) const {
  const int first = x + margin;
  if (first <= -64 || first >= 64 * stride_) return 0;
  const std::uint64_t* row = &rows[std::size_t(y) * std::size_t(stride_)];
  if (first < 0) return row[0] << -first;
  const int w = first / 64, shift = first % 64;
  const std::uint64_t low = row[w] >> shift;
  return shift == 0 || w + 1 == stride_ ? low : low | row[w + 1] << (64 - shift);
}

template <class Use>
void SurfaceBits::for_rows(int x, int y, int r, const Use& use) const {
  const int left = x - r;
  const std::uint64_t window = ones(2 * r + 1), centre = bit_at(r);
  const std::uint64_t middle = spread_out(centre, at(right_, left, y) & window, r, r) & window;
  use(0, middle);
  // From the row before, inside the diagonals straight and along them aslant; then outwards within the row.
  std::uint64_t row = middle;
  for (int k = 1; k <= r && y - k >= 0 && row != 0; ++k) {
    const std::uint64_t inner = ones(2 * k - 1) << (r - k + 1);
    const std::uint64_t straight = row & inner & at(down_, left, y - k);
    const std::uint64_t right = (row & at(down_left_, left, y - k)) << 1 & bit_at(r + k);
    const std::uint64_t aslant = row >> 1 & at(down_right_, left, y - k) & bit_at(r - k);
    row = spread_out(straight | right | aslant, at(right_, left, y - k), r - k, r + k) & window;
    use(-k, row);
  }
  row = middle;
  for (int k = 1; k <= r && y + k < map_->height && row != 0; ++k) {
    const std::uint64_t inner = ones(2 * k - 1) << (r - k + 1);
    const std::uint64_t straight = row & inner & at(down_, left, y + k - 1);
    const std::uint64_t right = (row & at(down_right_, left, y + k - 1)) << 1 & bit_at(r + k);
    const std::uint64_t aslant = row >> 1 & at(down_left_, left, y + k - 1) & bit_at(r - k);
    row = spread_out(straight | right | aslant, at(right_, left, y + k), r - k, r + k) & window;
    use(k, row);
  }
}

Counted SurfaceBits::count(int x, int y, int r) const {
  Counted counted;
  for_rows(x, y, r, [&](int dy, std::uint64_t row) {
    counted.all += std::popcount(row);
    counted.open += std::popcount(row & at(open_, x - r, y + dy));
  });
  return counted;
}

Counted SurfaceBits::count_all(int x, int y, int r) const {
  Counted counted;
  for (int row = std::max(0, y - r); row <= std::min(map_->height - 1, y + r); ++row) {
    const std::uint64_t seen = at(seen_, x - r, row) & ones(2 * r + 1);
    counted.all += std::popcount(seen);
    counted.open += std::popcount(seen & at(open_, x - r, row));
  }
  return counted;
}

float SurfaceBits::borrowed_caster(int x, int y, int r) const {
  int least = std::numeric_limits<int>::max(), nearest_x = 0, nearest_y = 0;
  const auto look_at = [&](int dx, int dy) {
    const int distance = dx * dx + dy * dy;
    const bool first = dy < nearest_y || (dy == nearest_y && dx < nearest_x);  // rows do not come in their order
    if (distance < least || (distance == least && first)) least = distance, nearest_x = dx, nearest_y = dy;
  };
  for_rows(x, y, r, [&](int dy, std::uint64_t row) {
    const std::uint64_t dark = row & ~at(open_, x - r, y + dy);
    if (const std::uint64_t left = dark & ones(r + 1)) look_at(int(std::bit_width(left)) - 1 - r, dy);
    if (const std::uint64_t right = dark >> r) look_at(std::countr_zero(right), dy);
  });
  if (least == std::numeric_limits<int>::max()) return std::numeric_limits<float>::infinity();
  return map_->caster[map_->index(x + nearest_x, y + nearest_y)];
}

}  // namespace penumbra::visibility_filter
