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

enum class Layout { full, reduced };

/// What a square knows of its depths. Where a texel of it is empty, `high` and `mean` are infinite.
struct DepthRange {
  float low, high, mean;
};

class MultiScaleMap {
 public:
  /// Levels 0 (the map itself) to `largest`, at most floor(log2(resolution)).
  void build(const ShadowMap& map, Layout layout, int largest, bool parallel);

  int edge() const { return edge_; }        ///< of the map, texels
  int largest() const { return largest_; }  ///< level
  /// Squares along an edge of a level; also its row stride.
  int stride(int level) const { return layout_ == Layout::full ? edge_ : edge_ - (1 << level) + 1; }
  /// Index of a square in low(), high(), mean(): level by level, each at a multiple of edge^2.
  std::size_t index(int left, int top, int level) const {
    return std::size_t(level) * edge_ * edge_ + std::size_t(top) * stride(level) + left;
  }
  float low(const Square& s) const { return low_[index(s.left, s.top, s.level)]; }
  DepthRange range(const Square& s) const {
    const std::size_t i = index(s.left, s.top, s.level);
    return {low_[i], high_[i], mean_[i]};
  }
  float depth(int x, int y) const { return low_[std::size_t(y) * edge_ + x]; }
  const float* low() const { return low_.get(); }
  const float* high() const { return high_.get(); }
  const float* mean() const { return mean_.get(); }
  Layout layout() const { return layout_; }
  std::size_t bytes() const;

 private:
  void allocate(int edge, int largest);
  void build_rows(int level, int begin, int end);

  Layout layout_ = Layout::reduced;
  int edge_ = 0, largest_ = -1, allocated_ = 0;
  std::unique_ptr<float[]> low_, high_, mean_;
};

/// Largest level whose squares fit a map.
int largest_level(int edge);

}  // namespace penumbra::pcss
