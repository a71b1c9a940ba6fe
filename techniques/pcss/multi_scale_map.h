// Least, largest and mean depth of every square of 2^i texels of a shadow map, at every offset (N-buffers, Decoret
// 2005; Shen et al. 2014). Level i + 1 at q takes four squares of level i: at q, and 2^i further right, down, and both.
//
//   full:    every offset; squares that stick out count only their texels on the map (Shen et al. 2014).
//   reduced: only squares that lie on the map, (n - 2^i + 1)^2 of them (Zhu et al. 2019, section 2).
#pragma once

#include <memory>

#include "techniques/bases/shadow_map/region.h"
#include "techniques/bases/shadow_map/shadow_map.h"

namespace penumbra::pcss {
using namespace shadow_map;  // NOLINT: its base

enum class LevelLayout { full, reduced };

/// Least and largest depth in a square; `high` is infinite, and so is the mean, where a texel of it is empty.
struct DepthRange {
  float low, high;
};

/// The squares, wherever the numbers lie (`Floats` is an array of them).
template <class Floats>
class MultiScaleLevels {
 public:
  MultiScaleLevels() = default;
  PENUMBRA_HD MultiScaleLevels(LevelLayout layout, int edge, int largest, Floats bounds, Floats means)
      : layout_(layout), edge_(edge), largest_(largest), bounds_(bounds), mean_(means) {}

  PENUMBRA_HD int edge() const { return edge_; }        ///< of the map, texels
  PENUMBRA_HD int largest() const { return largest_; }  ///< level
  /// Squares along an edge of a level; also its row stride.
  PENUMBRA_HD int stride(int level) const { return layout_ == LevelLayout::full ? edge_ : edge_ - (1 << level) + 1; }
  /// Number of a square in bounds() and means(): level by level, each from a multiple of edge^2 on.
  PENUMBRA_HD std::size_t index(int left, int top, int level) const {
    return std::size_t(level) * std::size_t(edge_) * std::size_t(edge_) +
           std::size_t(top) * std::size_t(stride(level)) + std::size_t(left);
  }
  PENUMBRA_HD float low(const Square& s) const { return bounds_[2 * index(s.left, s.top, s.level)]; }
  PENUMBRA_HD DepthRange range(const Square& s) const {
    const std::size_t i = index(s.left, s.top, s.level);
    return {bounds_[2 * i], -bounds_[2 * i + 1]};
  }
  PENUMBRA_HD float mean(const Square& s) const { return mean_[index(s.left, s.top, s.level)]; }
  LevelLayout layout() const { return layout_; }

  /// A square of level 0: the texel's depth.
  PENUMBRA_HD void set_texel(int x, int y, float depth) const {
    const std::size_t i = index(x, y, 0);
    bounds_[2 * i] = mean_[i] = depth, bounds_[2 * i + 1] = -depth;
  }
  /// A square of a higher level, from the four of the level before. One that sticks out of the map (full layout) takes
  /// those that are on it; their means are weighted by texels.
  PENUMBRA_HD void merge(int x, int y, int level) const;
  /// One that sticks out, from the numbers of the four squares and of their texels on the map.
  PENUMBRA_HD void merge_cut(std::size_t out, const std::size_t from[4], const float texels[4]) const;

 protected:
  LevelLayout layout_ = LevelLayout::reduced;
  int edge_ = 0, largest_ = -1;
  /// bounds: two numbers a square, its least depth, and its largest one negated, so that both are minima. Side by side,
  /// since who asks for one asks for the other.
  Floats bounds_{}, mean_{};
};

namespace detail {

PENUMBRA_HD inline float least(float a, float b, float c, float d) {
  const float ab = b < a ? b : a, cd = d < c ? d : c;
  return cd < ab ? cd : ab;
}
PENUMBRA_HD inline float average(float a, float b, float c, float d) {
  return 0.25f * ((a + b) + (c + d));
}
/// How many of `size` texels from `start` on lie on a map of `edge`.
PENUMBRA_HD inline int on_map(int start, int size, int edge) {
  const int left = edge - start;
  return left < 0 ? 0 : left < size ? left : size;
}

}  // namespace detail

template <class Floats>
PENUMBRA_HD void MultiScaleLevels<Floats>::merge_cut(std::size_t out, const std::size_t from[4],
                                                     const float texels[4]) const {
  for (std::size_t k = 0; k < 2; ++k)
    bounds_[2 * out + k] = detail::least(bounds_[2 * from[0] + k], bounds_[2 * from[1] + k], bounds_[2 * from[2] + k],
                                         bounds_[2 * from[3] + k]);
  const auto weighted = [&](int k) { return texels[k] > 0.0f ? texels[k] * mean_[from[k]] : 0.0f; };
  mean_[out] =
      (weighted(0) + weighted(1) + weighted(2) + weighted(3)) / ((texels[0] + texels[1]) + (texels[2] + texels[3]));
}

template <class Floats>
PENUMBRA_HD void MultiScaleLevels<Floats>::merge(int x, int y, int level) const {
  const int below = level - 1, step = 1 << below;
  const std::size_t right = x + step < edge_ ? std::size_t(step) : 0, a = index(x, y, below), b = a + right;
  const std::size_t c = y + step < edge_ ? index(x, y + step, below) : a, d = c + right, out = index(x, y, level);
  if (x + 2 * step > edge_ || y + 2 * step > edge_) {
    const auto wide = float(detail::on_map(x, step, edge_)), far = float(detail::on_map(x + step, step, edge_));
    const auto tall = float(detail::on_map(y, step, edge_)), flat = float(detail::on_map(y + step, step, edge_));
    const std::size_t from[4] = {a, b, c, d};
    const float texels[4] = {wide * tall, far * tall, wide * flat, far * flat};
    return merge_cut(out, from, texels);
  }
  for (std::size_t k = 0; k < 2; ++k)
    bounds_[2 * out + k] =
        detail::least(bounds_[2 * a + k], bounds_[2 * b + k], bounds_[2 * c + k], bounds_[2 * d + k]);
  mean_[out] = detail::average(mean_[a], mean_[b], mean_[c], mean_[d]);
}

/// The map that owns its numbers.
class MultiScaleMap : public MultiScaleLevels<float*> {
 public:
  /// Builds levels 0 (the map itself) to `largest`, at most floor(log2(resolution)).
  void build(const ShadowMap& map, LevelLayout layout, int largest);
  const float* bounds() const { return bounds_; }
  const float* means() const { return mean_; }
  std::size_t bytes() const;

 private:
  void allocate(int edge, int largest);
  void build_rows(int level, int begin, int end);

  int allocated_ = 0;
  std::unique_ptr<float[]> bounds_memory_, mean_memory_;
};

/// Returns the largest level whose squares fit a map.
int largest_level(int edge);

}  // namespace penumbra::pcss
