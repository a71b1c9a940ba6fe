#include "techniques/pcss/kernel.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "techniques/pcss/sample_kernel.cpp"
#include <hwy/foreach_target.h>  // IWYU pragma: keep

#include "techniques/pcss/point-inl.h"

HWY_BEFORE_NAMESPACE();
namespace penumbra::pcss::simd {
namespace HWY_NAMESPACE {

/// Depth of the texel that holds (x, y); infinity outside the map.
HWY_INLINE VF DepthAt(const ShadowMap& map, VI column, VI row) {
  const Floats d;
  const int n = map.resolution();
  const VI zero = SetInt(0), end = SetInt(n);
  const auto outside = hn::Or(hn::Or(hn::Lt(column, zero), hn::Lt(row, zero)),
                              hn::Or(hn::Not(hn::Lt(column, end)), hn::Not(hn::Lt(row, end))));
  const VI index = hn::IfThenZeroElse(outside, hn::Add(hn::Mul(row, SetInt(map.stride())), column));
  return hn::IfThenElse(hn::RebindMask(d, outside), hn::Set(d, std::numeric_limits<float>::infinity()),
                        hn::GatherIndex(d, map.depth.data(), index));
}

void HardShadow(const ShadowMap& map, int kernel, Tile& tile) {
  const Floats d;
  const VF one = hn::Set(d, 1.0f);
  for (int k = 0; k < tile.size(); k += int(hn::Lanes(d))) {
    const VF depth = hn::LoadU(d, &tile.depth[k]);
    const VI left = hn::Sub(FloorInt(hn::LoadU(d, &tile.x[k])), SetInt((kernel - 1) / 2));
    const VI top = hn::Sub(FloorInt(hn::LoadU(d, &tile.y[k])), SetInt((kernel - 1) / 2));
    VF open = hn::Zero(d);
    for (int v = 0; v < kernel; ++v)
      for (int u = 0; u < kernel; ++u) {
        const VF z = DepthAt(map, hn::Add(left, SetInt(u)), hn::Add(top, SetInt(v)));
        open = hn::Add(open, hn::IfThenZeroElse(hn::Lt(z, depth), one));
      }
    hn::StoreU(hn::Div(open, hn::Set(d, float(kernel * kernel))), d, &tile.visibility[k]);
  }
}

/// Calls use(z) with the depth at each sample, placed() as the pattern wants.
template <class Use>
HWY_INLINE void ForSamples(const ShadowMap& map, Pattern kind, const std::vector<vec2>& samples, VF x, VF y, VF width,
                           VF u, VF v, const Use& use) {
  const Floats d;
  const VF half = hn::Set(d, 0.5f);
  for (const vec2& s : samples) {
    const VF sx = hn::Set(d, s.x), sy = hn::Set(d, s.y);
    VF px, py;
    if (kind == Pattern::lattice) {
      px = hn::Add(sx, u), py = hn::Add(sy, v);
      px = hn::Sub(hn::Sub(px, hn::Floor(px)), half), py = hn::Sub(hn::Sub(py, hn::Floor(py)), half);
    } else {
      px = hn::Sub(hn::Mul(u, sx), hn::Mul(v, sy)), py = hn::Add(hn::Mul(v, sx), hn::Mul(u, sy));
    }
    use(DepthAt(map, FloorInt(hn::Add(x, hn::Mul(width, px))), FloorInt(hn::Add(y, hn::Mul(width, py)))));
  }
}

void RotatedBlockers(const ShadowMap& map, const SamplePattern& pattern, const Turns& turns, Tile& tile) {
  const Floats d;
  const VF zero = hn::Zero(d), one = hn::Set(d, 1.0f), near = hn::Set(d, map.view.near);
  for (int k = 0; k < tile.size(); k += int(hn::Lanes(d))) {
    const VF depth = hn::LoadU(d, &tile.depth[k]);
    const MF open = hn::Gt(depth, near);
    VF sum = zero, count = zero;
    if (!hn::AllFalse(d, open)) {
      const VF width = Region(map.view, near, hn::Max(depth, near));
      ForSamples(map, pattern.kind, pattern.search, hn::LoadU(d, &tile.x[k]), hn::LoadU(d, &tile.y[k]), width,
                 hn::LoadU(d, &turns.u[k]), hn::LoadU(d, &turns.v[k]), [&](VF z) {
                   const MF closer = hn::Lt(z, depth);
                   sum = hn::Add(sum, hn::IfThenElseZero(closer, z));
                   count = hn::Add(count, hn::IfThenElseZero(closer, one));
                 });
    }
    const MF found = hn::And(open, hn::Gt(count, zero));
    hn::StoreU(hn::IfThenElseZero(found, hn::Div(sum, hn::Max(count, one))), d, &tile.blocker[k]);
  }
}

void RotatedFilter(const ShadowMap& map, const SamplePattern& pattern, const Turns& turns, float scale, Tile& tile) {
  const Floats d;
  const VF zero = hn::Zero(d), one = hn::Set(d, 1.0f);
  for (int k = 0; k < tile.size(); k += int(hn::Lanes(d))) {
    const VF depth = hn::LoadU(d, &tile.depth[k]), blocker = hn::LoadU(d, &tile.blocker[k]);
    const MF some = hn::Gt(blocker, zero);
    VF closer = zero;
    if (!hn::AllFalse(d, some)) {
      const VF width = Region(map.view, hn::IfThenElse(some, blocker, one), hn::IfThenElse(some, depth, one), scale);
      ForSamples(map, pattern.kind, pattern.filter, hn::LoadU(d, &tile.x[k]), hn::LoadU(d, &tile.y[k]), width,
                 hn::LoadU(d, &turns.u[k]), hn::LoadU(d, &turns.v[k]),
                 [&](VF z) { closer = hn::Add(closer, hn::IfThenElseZero(hn::Lt(z, depth), one)); });
    }
    const VF share = hn::Div(closer, hn::Set(d, float(pattern.filter.size())));
    hn::StoreU(hn::Sub(one, hn::IfThenElseZero(some, share)), d, &tile.visibility[k]);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace penumbra::pcss::simd
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace penumbra::pcss::simd {

HWY_EXPORT(HardShadow);
HWY_EXPORT(RotatedBlockers);
HWY_EXPORT(RotatedFilter);

void hard_shadow(const ShadowMap& map, int kernel, Tile& tile) {
  HWY_DYNAMIC_DISPATCH(HardShadow)(map, kernel, tile);
}
void rotated_blockers(const ShadowMap& map, const SamplePattern& pattern, const Turns& turns, Tile& tile) {
  HWY_DYNAMIC_DISPATCH(RotatedBlockers)(map, pattern, turns, tile);
}
void rotated_filter(const ShadowMap& map, const SamplePattern& pattern, const Turns& turns, float scale, Tile& tile) {
  HWY_DYNAMIC_DISPATCH(RotatedFilter)(map, pattern, turns, scale, tile);
}

}  // namespace penumbra::pcss::simd
#endif  // HWY_ONCE
