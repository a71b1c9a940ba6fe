#include "techniques/pcss/kernel.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "techniques/pcss/point_kernel.cpp"
#include <hwy/foreach_target.h>  // IWYU pragma: keep

#include "techniques/bases/shadow_map/point-inl.h"

HWY_BEFORE_NAMESPACE();
namespace penumbra::pcss::simd {
namespace HWY_NAMESPACE {
using namespace penumbra::shadow_map::simd::HWY_NAMESPACE;  // NOLINT: its base, for the same instruction set

struct Squares {
  VI left, top, level;
};

HWY_INLINE VI SnappedLevel(VI w, Snapping::Size size) {
  // The exponent of w as a float; adding half a mantissa rounds it up where the second-highest bit of w is set.
  const VI bits = hn::BitCast(Ints(), hn::ConvertTo(Floats(), w));
  const VI carry = SetInt(size == Snapping::Size::nearest ? 0x400000 : 0x7fffff);
  return hn::Sub(hn::ShiftRight<23>(hn::Add(bits, carry)), SetInt(127));
}

HWY_INLINE void SnappedRange(VF centre, VF width, int edge, bool inclusive, VI& first, VI& last) {
  const VF half = hn::Mul(hn::Set(Floats(), 0.5f), width);
  first = FloorInt(hn::Sub(centre, half));
  last = hn::Sub(CeilInt(hn::Add(centre, half)), SetInt(inclusive ? 0 : 1));
  last = hn::Max(first, last);
  first = hn::Max(first, SetInt(0));
  last = hn::Min(last, SetInt(edge - 1));
}

HWY_INLINE VI SnappedStart(VI first, VF centre, VI square, int edge, bool centred) {
  const Floats d;
  VI start = first;
  if (centred) {
    const VF half = hn::Mul(hn::Set(d, 0.5f), hn::ConvertTo(d, square));
    start = FloorInt(hn::Add(hn::Sub(centre, half), hn::Set(d, 0.5f)));
  }
  return hn::Min(hn::Max(start, SetInt(0)), hn::Sub(SetInt(edge), square));
}

/// snap().
HWY_INLINE Squares Snap(VF x, VF y, VF width, int edge, int largest, const Snapping& how) {
  VI left, right, top, bottom;
  SnappedRange(x, width, edge, how.inclusive, left, right);
  SnappedRange(y, width, edge, how.inclusive, top, bottom);
  const VI one = SetInt(1);
  const VI w = hn::Sub(right, left), h = hn::Sub(bottom, top);
  const auto none = hn::Lt(hn::Min(w, h), SetInt(0));
  const VI across = SnappedLevel(hn::Max(one, hn::Add(w, one)), how.size);
  const VI down = SnappedLevel(hn::Max(one, hn::Add(h, one)), how.size);
  VI level = hn::IfThenElse(hn::Eq(across, down), across, hn::Add(hn::Min(across, down), one));
  level = hn::Min(level, SetInt(largest));
  const VI square = hn::Shl(one, level);
  return {SnappedStart(left, x, square, edge, how.centred), SnappedStart(top, y, square, edge, how.centred),
          hn::IfThenElse(none, SetInt(-1), level)};
}

/// MultiScaleMap::index.
HWY_INLINE VI Index(const MultiScaleMap& map, const Squares& s) {
  const VI edge = SetInt(map.edge());
  const VI level = hn::Max(s.level, SetInt(0));
  const VI stride =
      map.layout() == LevelLayout::full ? edge : hn::Add(hn::Sub(edge, hn::Shl(SetInt(1), level)), SetInt(1));
  return hn::Add(hn::Add(hn::Mul(level, SetInt(map.edge() * map.edge())), hn::Mul(s.top, stride)), s.left);
}

HWY_INLINE void StoreSquares(const Squares& s, Square* out) {
  static_assert(sizeof(Square) == 3 * sizeof(int));
  hn::StoreInterleaved3(s.left, s.top, s.level, Ints(), &out->left);
}

/// Own number where the mask holds, -1 elsewhere.
HWY_INLINE void StoreRepresentatives(MF open, int k, int* out) {
  const Ints di;
  const VI own = hn::Iota(di, k);
  hn::StoreU(hn::IfThenElse(hn::RebindMask(di, open), own, SetInt(-1)), di, out);
}

void SearchRegions(const LightView& view, const MultiScaleMap& levels, const SoftOptions& options, Tile& tile) {
  const Floats d;
  const Ints di;
  const int n = view.resolution;
  const VF near = hn::Set(d, view.near);
  for (int k = 0; k < tile.size(); k += int(hn::Lanes(d))) {
    const VF x = hn::LoadU(d, &tile.x[k]), y = hn::LoadU(d, &tile.y[k]), depth = hn::LoadU(d, &tile.depth[k]);
    MF open = hn::Gt(depth, near);
    const VF safe = hn::Max(depth, near);
    VF width = RegionWidth(view, near, safe);
    // misses_map()
    const VF half = hn::Mul(hn::Set(d, 0.5f), width), zero = hn::Zero(d), end = hn::Set(d, float(n));
    const MF reaches = hn::And(hn::Ge(hn::Add(x, half), zero), hn::Ge(hn::Add(y, half), zero));
    const MF begins = hn::And(hn::Lt(hn::Sub(x, half), end), hn::Lt(hn::Sub(y, half), end));
    open = hn::And(open, hn::And(reaches, begins));
    Squares squares = {SetInt(0), SetInt(0), SetInt(-1)};
    if (options.refine) {
      MF searching = open;
      for (int i = 0; i < most_refinements && !hn::AllFalse(d, searching); ++i) {
        squares = Snap(x, y, width, n, levels.largest(), options.snapping);
        const MF there = hn::RebindMask(d, hn::Gt(squares.level, SetInt(-1)));
        const MF look = hn::And(searching, there);
        const VI index = hn::IfThenElseZero(hn::RebindMask(di, look), Index(levels, squares));
        const VF low = hn::GatherIndex(d, levels.bounds(), hn::Add(index, index));
        const MF hit = hn::And(look, hn::Lt(low, BlockingDepth(depth, hn::LoadU(d, &tile.rise[k]), width)));
        open = hn::And(open, hn::Or(hit, hn::Not(searching)));
        const VF next = hn::Min(width, RegionWidth(view, low, safe));
        searching = hn::And(hit, hn::Ge(hn::Sub(width, next), hn::Set(d, 1.0f)));
        width = hn::IfThenElse(hit, next, width);
      }
    }
    if (options.multi_scale) {
      squares = Snap(x, y, width, n, levels.largest(), options.snapping);
      open = hn::And(open, hn::RebindMask(d, hn::Gt(squares.level, SetInt(-1))));
    }
    hn::StoreU(width, d, &tile.width[k]);
    StoreSquares(squares, &tile.square[k]);
    StoreRepresentatives(open, k, &tile.representative[k]);
  }
}

void FilterRegions(const LightView& view, const MultiScaleMap& levels, const SoftOptions& options, Tile& tile) {
  const Floats d;
  const Ints di;
  const int n = view.resolution;
  const VF zero = hn::Zero(d), one = hn::Set(d, 1.0f);
  for (int k = 0; k < tile.size(); k += int(hn::Lanes(d))) {
    const VF x = hn::LoadU(d, &tile.x[k]), y = hn::LoadU(d, &tile.y[k]), depth = hn::LoadU(d, &tile.depth[k]);
    const VI representative = hn::LoadU(di, &tile.representative[k]);
    const auto linked = hn::Gt(representative, SetInt(-1));
    const VF blocker = hn::GatherIndex(d, tile.blocker.data(), hn::IfThenElseZero(linked, representative));
    MF open = hn::And(hn::RebindMask(d, linked), hn::And(hn::Gt(blocker, zero), hn::Lt(blocker, depth)));
    const VF safe = hn::IfThenElse(open, blocker, one), safe_depth = hn::IfThenElse(open, depth, one);
    const VF width = RegionWidth(view, safe, safe_depth, options.filter_scale);
    hn::StoreU(hn::IfThenElse(open, width, hn::LoadU(d, &tile.width[k])), d, &tile.width[k]);
    if (options.multi_scale) {
      const Squares squares = Snap(x, y, width, n, levels.largest(), options.snapping);
      open = hn::And(open, hn::RebindMask(d, hn::Gt(squares.level, SetInt(-1))));
      StoreSquares(squares, &tile.square[k]);
    }
    hn::StoreU(one, d, &tile.visibility[k]);
    StoreRepresentatives(open, k, &tile.representative[k]);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace penumbra::pcss::simd
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace penumbra::pcss::simd {

HWY_EXPORT(SearchRegions);
HWY_EXPORT(FilterRegions);

void search_regions(const LightView& view, const MultiScaleMap& levels, const SoftOptions& options, Tile& tile) {
  HWY_DYNAMIC_DISPATCH(SearchRegions)(view, levels, options, tile);
}
void filter_regions(const LightView& view, const MultiScaleMap& levels, const SoftOptions& options, Tile& tile) {
  HWY_DYNAMIC_DISPATCH(FilterRegions)(view, levels, options, tile);
}

}  // namespace penumbra::pcss::simd
#endif  // HWY_ONCE
