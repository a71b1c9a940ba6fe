#include "techniques/pcss/multi_scale_map.h"

#include <algorithm>

#include "techniques/bases/for_ranges.h"

namespace penumbra::pcss {

int largest_level(int edge) {
  return int(std::bit_width(unsigned(edge))) - 1;
}

void MultiScaleMap::allocate(int edge, int largest) {
  if (edge == edge_ && largest <= allocated_) return;
  edge_ = edge;
  allocated_ = largest;
  const std::size_t size = std::size_t(largest + 1) * edge * edge;  // pages of it that no square fills stay untouched
  bounds_memory_ = std::make_unique_for_overwrite<float[]>(2 * size);
  mean_memory_ = std::make_unique_for_overwrite<float[]>(size);
  bounds_ = bounds_memory_.get(), mean_ = mean_memory_.get();
}

std::size_t MultiScaleMap::bytes() const {
  std::size_t squares = 0;
  for (int level = 0; level <= largest_; ++level) squares += std::size_t(stride(level)) * stride(level);
  return 3 * sizeof(float) * squares;
}

namespace {

/// Four squares become one, for the first `count` numbers of a row: two of the row `top` of the level before, `step`
/// numbers apart, and two of the row `bottom`, as far below.
template <class Merge>
void merge_row(const float* top, const float* bottom, int step, int count, float* out, const Merge& merge) {
  for (int x = 0; x < count; ++x) out[x] = merge(top[x], top[x + step], bottom[x], bottom[x + step]);
}

}  // namespace

void MultiScaleMap::build_rows(int level, int begin, int end) {
  const int below = level - 1, step = 1 << below;
  const int inner = edge_ - (1 << level) + 1;  // offsets whose squares lie on the map
  for (int y = begin; y < end; ++y) {
    const int whole = y < inner ? inner : 0;
    const std::size_t top = index(0, y, below), bottom = y + step < edge_ ? index(0, y + step, below) : top;
    const std::size_t out = index(0, y, level);
    merge_row(&bounds_[2 * top], &bounds_[2 * bottom], 2 * step, 2 * whole, &bounds_[2 * out], detail::least);
    merge_row(&mean_[top], &mean_[bottom], step, whole, &mean_[out], detail::average);
    // Only the full layout has more: squares that stick out.
    const auto tall = float(detail::on_map(y, step, edge_)), flat = float(detail::on_map(y + step, step, edge_));
    for (int x = whole; x < stride(level); ++x) {
      const std::size_t right = x + step < edge_ ? std::size_t(step) : 0, column = std::size_t(x);
      const auto wide = float(detail::on_map(x, step, edge_)), far = float(detail::on_map(x + step, step, edge_));
      const std::size_t from[4] = {top + column, top + column + right, bottom + column, bottom + column + right};
      const float texels[4] = {wide * tall, far * tall, wide * flat, far * flat};
      merge_cut(out + column, from, texels);
    }
  }
}

void MultiScaleMap::build(const ShadowMap& map, LevelLayout layout, int largest) {
  largest = std::clamp(largest, 0, largest_level(map.resolution()));
  layout_ = layout;
  allocate(map.resolution(), largest);
  largest_ = largest;
  for_ranges(edge_, 16, [&](int begin, int end) {
    for (int y = begin; y < end; ++y)
      for (int x = 0; x < edge_; ++x) set_texel(x, y, map.at(x, y));
  });
  for (int level = 1; level <= largest; ++level)
    for_ranges(stride(level), 16, [&](int begin, int end) { build_rows(level, begin, end); });
}

}  // namespace penumbra::pcss
