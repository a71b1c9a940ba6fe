// Least, largest and mean depth of every square of 2^i texels of a shadow map, at every offset (N-buffers, Decoret
// 2005; Shen et al. 2014). Level i + 1 at q takes four squares of level i: at q, and 2^i further right, down, and both.
//
//   full:    every offset; squares that stick out count only their texels on the map (Shen et al. 2014).
//   reduced: only squares that lie on the map, (n - 2^i + 1)^2 of them (Zhu et al. 2019, section 2).
#pragma once

#include <memory>

#include "techniques/pcss/region.h"
#include "techniques/pcss/shadow_map.h"

namespace penumbra::pcss {

enum class LevelLayout { full, reduced };

/// Least and largest depth in a square; `high` is infinite, and so is the mean, where a texel of it is empty.
struct DepthRange {
  float low, high;
};

class MultiScaleMap {
 public:
  /// Levels 0 (the map itself) to `largest`, at most floor(log2(resolution)).
  void build(const ShadowMap& map, LevelLayout layout, int largest, bool parallel);

  int edge() const { return edge_; }        ///< of the map, texels
  int largest() const { return largest_; }  ///< level
  /// Squares along an edge of a level; also its row stride.
  int stride(int level) const { return layout_ == LevelLayout::full ? edge_ : edge_ - (1 << level) + 1; }
  /// Number of a square in bounds() and mean(): level by level, each from a multiple of edge^2 on.
  std::size_t index(int left, int top, int level) const {
    return std::size_t(level) * edge_ * edge_ + std::size_t(top) * stride(level) + left;
  }
  float low(const Square& s) const { return bounds_[2 * index(s.left, s.top, s.level)]; }
  DepthRange range(const Square& s) const {
    const std::size_t i = index(s.left, s.top, s.level);
    return {bounds_[2 * i], -bounds_[2 * i + 1]};
  }
  float mean(const Square& s) const { return mean_[index(s.left, s.top, s.level)]; }
  /// Two numbers a square: its least depth, and its largest one negated, so that both are minima. Side by side, since
  /// who asks for one asks for the other.
  const float* bounds() const { return bounds_.get(); }
  const float* means() const { return mean_.get(); }
  LevelLayout layout() const { return layout_; }
  std::size_t bytes() const;

 private:
  void allocate(int edge, int largest);
  void build_rows(int level, int begin, int end);

  LevelLayout layout_ = LevelLayout::reduced;
  int edge_ = 0, largest_ = -1, allocated_ = 0;
  std::unique_ptr<float[]> bounds_, mean_;
};

/// Largest level whose squares fit a map.
int largest_level(int edge);

}  // namespace penumbra::pcss
