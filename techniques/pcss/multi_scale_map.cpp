#include "techniques/pcss/multi_scale_map.h"

#include <tbb/parallel_for.h>

#include <algorithm>

namespace penumbra::pcss {

int largest_level(int edge) {
  return int(std::bit_width(unsigned(edge))) - 1;
}

void MultiScaleMap::allocate(int edge, int largest) {
  if (edge == edge_ && largest <= allocated_) return;
  edge_ = edge;
  allocated_ = largest;
  const std::size_t size = std::size_t(largest + 1) * edge * edge;  // pages of it that no square fills stay untouched
  for (auto* field : {&low_, &high_, &mean_}) *field = std::make_unique_for_overwrite<float[]>(size);
}

std::size_t MultiScaleMap::bytes() const {
  std::size_t squares = 0;
  for (int level = 0; level <= largest_; ++level) squares += std::size_t(stride(level)) * stride(level);
  return 3 * sizeof(float) * squares;
}

namespace {

/// Four squares of one row of offsets become one, for `count` offsets whose parts all lie on the map.
void merge_row(const float* top, const float* bottom, int step, int count, int kind, float* out) {
  if (kind == 0)
    for (int x = 0; x < count; ++x)
      out[x] = std::min(std::min(top[x], top[x + step]), std::min(bottom[x], bottom[x + step]));
  else if (kind == 1)
    for (int x = 0; x < count; ++x)
      out[x] = std::max(std::max(top[x], top[x + step]), std::max(bottom[x], bottom[x + step]));
  else
    for (int x = 0; x < count; ++x) out[x] = 0.25f * ((top[x] + top[x + step]) + (bottom[x] + bottom[x + step]));
}

/// How many of `size` texels from `start` on lie on a map of `edge`.
int on_map(int start, int size, int edge) {
  return std::clamp(edge - start, 0, size);
}

}  // namespace

void MultiScaleMap::build_rows(int level, int begin, int end) {
  const int below = level - 1, step = 1 << below, from = stride(below), to = stride(level);
  const int inner = edge_ - (1 << level) + 1;  // offsets whose squares lie on the map
  float* fields[] = {low_.get(), high_.get(), mean_.get()};
  for (int y = begin; y < end; ++y)
    for (int kind = 0; kind < 3; ++kind) {
      const bool cut = y >= inner;
      const float* top = fields[kind] + index(0, y, below);
      const float* bottom = y + step < edge_ ? top + std::size_t(step) * from : top;
      float* out = fields[kind] + index(0, y, level);
      if (!cut) merge_row(top, bottom, step, inner, kind, out);
      // Only the full layout has more: squares that stick out, their means weighted by texels on the map.
      const float tall = float(on_map(y, step, edge_)), low = float(on_map(y + step, step, edge_));
      for (int x = cut ? 0 : inner; x < to; ++x) {
        const int right = x + step < edge_ ? x + step : x;
        if (kind == 0) out[x] = std::min(std::min(top[x], top[right]), std::min(bottom[x], bottom[right]));
        if (kind == 1) out[x] = std::max(std::max(top[x], top[right]), std::max(bottom[x], bottom[right]));
        if (kind == 2) {
          const float wide = float(on_map(x, step, edge_)), far = float(on_map(x + step, step, edge_));
          const auto weighted = [](float value, float weight) { return weight > 0.0f ? weight * value : 0.0f; };
          const float sum = weighted(top[x], wide * tall) + weighted(top[right], far * tall) +
                            weighted(bottom[x], wide * low) + weighted(bottom[right], far * low);
          out[x] = sum / ((wide + far) * (tall + low));
        }
      }
    }
}

void MultiScaleMap::build(const ShadowMap& map, Layout layout, int largest, bool parallel) {
  largest = std::clamp(largest, 0, largest_level(map.resolution()));
  layout_ = layout;
  allocate(map.resolution(), largest);
  largest_ = largest;
  for (auto* field : {&low_, &high_, &mean_}) std::copy_n(map.depth.begin(), map.texels(), field->get());
  for (int level = 1; level <= largest; ++level) {
    const int rows = stride(level);
    if (parallel)
      tbb::parallel_for(tbb::blocked_range<int>(0, rows, 16),
                        [&](const tbb::blocked_range<int>& r) { build_rows(level, r.begin(), r.end()); });
    else build_rows(level, 0, rows);
  }
}

}  // namespace penumbra::pcss
