// Square regions of the shadow map: as wanted, as texels, and as one of the squares that the multi-scale map stores
// (Zhu et al. 2019, section 2.2; algorithms that use it say so).
#pragma once

#include <bit>
#include <cmath>

#include "techniques/bases/shadow_map/light_view.h"

namespace penumbra::shadow_map {

/// Whole number at or below (above) v, |v| < 2^31; without a call to the C library where there is no such instruction.
PENUMBRA_HD inline int floor_int(float v) {
  const int i = int(v);
  return i - (float(i) > v ? 1 : 0);
}
PENUMBRA_HD inline int ceil_int(float v) {
  const int i = int(v);
  return i + (float(i) < v ? 1 : 0);
}

/// Texels [left, right) x [top, bottom), not yet cut to the map.
struct Texels {
  int left, right, top, bottom;
  PENUMBRA_HD int count() const { return (right - left) * (bottom - top); }
};

/// Texels whose centres lie within `width` of the point along an axis; at least the texel that holds it.
PENUMBRA_HD inline void texel_range(float centre, float width, int& first, int& last) {
  first = ceil_int(centre - 0.5f * width - 0.5f);
  last = floor_int(centre + 0.5f * width - 0.5f) + 1;
  if (first >= last) first = floor_int(centre), last = first + 1;
}

PENUMBRA_HD inline Texels texels_of(float x, float y, float width) {
  Texels t;
  texel_range(x, width, t.left, t.right);
  texel_range(y, width, t.top, t.bottom);
  return t;
}

/// Does a region lie off a map of `edge` texels?
PENUMBRA_HD inline bool misses_map(float x, float y, float width, int edge) {
  const float half = 0.5f * width, end = float(edge);
  return x + half < 0.0f || y + half < 0.0f || x - half >= end || y - half >= end;
}

/// Texels [left, left + 2^level) x [top, top + 2^level), all on the map; level -1: there is none.
struct Square {
  int left = 0, top = 0, level = -1;
  PENUMBRA_HD int edge() const { return 1 << level; }
  friend PENUMBRA_HD bool operator==(const Square&, const Square&) = default;
};

/// The readings of the paper's steps (its own first).
struct Snapping {
  bool inclusive = true;  ///< r = ceil(x + s / 2) is the last texel; otherwise one past it
  /// To the nearer power of two, or never smaller; overlap: refinement then looks at four squares that cover the
  /// region.
  enum class Size { nearest, up, overlap } size = Size::nearest;
  bool centred = false;  ///< the square keeps the region's centre instead of its corner
};

/// Exponent of the power of two that an edge of w >= 1 texels becomes (steps 3 and 4).
PENUMBRA_HD inline int snapped_level(int w, Snapping::Size size) {
  const int floor_log = int(std::bit_width(unsigned(w))) - 1;
  const bool power = w == 1 << floor_log;
  if (size != Snapping::Size::nearest) return power ? floor_log : floor_log + 1;
  const bool second_bit = floor_log > 0 && (w >> (floor_log - 1) & 1) != 0;
  return second_bit ? floor_log + 1 : floor_log;
}

/// One axis of steps 1 and 2: the region's texels, cut to a map of `edge` texels; last < first if it misses the map.
PENUMBRA_HD inline void snapped_range(float centre, float width, int edge, bool inclusive, int& first, int& last) {
  first = floor_int(centre - 0.5f * width);
  last = ceil_int(centre + 0.5f * width) - (inclusive ? 0 : 1);
  if (last < first) last = first;  // exclusive, width 0, on a whole number: the texel itself
  first = first > 0 ? first : 0;
  last = last < edge - 1 ? last : edge - 1;
}

/// Steps 5 to 7 along one axis: where the square starts, shifted onto the map.
PENUMBRA_HD inline int snapped_start(int first, float centre, int square, int edge, bool centred) {
  int start = centred ? floor_int(centre - 0.5f * float(square) + 0.5f) : first;
  start = start > 0 ? start : 0;
  return start + square > edge ? edge - square : start;
}

/// The stored square that stands for a region (steps 1 to 7) on a map of `edge` texels whose largest square is
/// 2^largest.
PENUMBRA_HD inline Square snap(float x, float y, float width, int edge, int largest, const Snapping& how) {
  int left, right, top, bottom;
  snapped_range(x, width, edge, how.inclusive, left, right);
  snapped_range(y, width, edge, how.inclusive, top, bottom);
  if (right < left || bottom < top) return {};
  const int across = snapped_level(right - left + 1, how.size), down = snapped_level(bottom - top + 1, how.size);
  int level = across == down ? across : (across < down ? across : down) + 1;
  level = level < largest ? level : largest;
  return {snapped_start(left, x, 1 << level, edge, how.centred), snapped_start(top, y, 1 << level, edge, how.centred),
          level};
}

}  // namespace penumbra::shadow_map
