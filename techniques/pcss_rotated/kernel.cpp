#include "techniques/pcss_rotated/pcss_rotated.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "techniques/pcss_rotated/kernel.cpp"
#include <hwy/foreach_target.h>  // IWYU pragma: keep

#include "techniques/bases/shadow_map/point-inl.h"
#include "techniques/bases/shadow_map/turned_samples-inl.h"

HWY_BEFORE_NAMESPACE();
namespace penumbra::pcss_rotated {
namespace HWY_NAMESPACE {
using namespace penumbra::shadow_map::simd::HWY_NAMESPACE;  // NOLINT: its base, for the same instruction set

/// Calls use(z) with the depth at each sample, placed() as the pattern wants.
template <class Use>
HWY_INLINE void ForSamples(const ShadowMap& map, Pattern kind, const std::vector<vec2>& samples, VF x, VF y, VF width,
                           VF u, VF v, const Use& use) {
  for (const vec2& s : samples) {
    VF px, py;
    Place(kind, s, u, v, px, py);
    use(DepthAt(map, FloorInt(hn::Add(x, hn::Mul(width, px))), FloorInt(hn::Add(y, hn::Mul(width, py)))));
  }
}

void FindBlockers(const ShadowMap& map, const SamplePattern& pattern, const Turns& turns, Tile& tile) {
  const Floats d;
  const VF zero = hn::Zero(d), one = hn::Set(d, 1.0f), near = hn::Set(d, map.view.near);
  for (int k = 0; k < tile.size(); k += int(hn::Lanes(d))) {
    const VF depth = hn::LoadU(d, &tile.depth[k]);
    const MF open = hn::Gt(depth, near);
    VF sum = zero, count = zero;
    if (!hn::AllFalse(d, open)) {
      const VF width = RegionWidth(map.view, near, hn::Max(depth, near));
      const VF limit = BlockingDepth(depth, hn::LoadU(d, &tile.rise[k]), width);
      ForSamples(map, pattern.kind, pattern.search, hn::LoadU(d, &tile.x[k]), hn::LoadU(d, &tile.y[k]), width,
                 hn::LoadU(d, &turns.u[k]), hn::LoadU(d, &turns.v[k]), [&](VF z) HWY_ATTR {
                   const MF closer = hn::Lt(z, limit);
                   sum = hn::Add(sum, hn::IfThenElseZero(closer, z));
                   count = hn::Add(count, hn::IfThenElseZero(closer, one));
                 });
    }
    const MF found = hn::And(open, hn::Gt(count, zero));
    hn::StoreU(hn::IfThenElseZero(found, hn::Div(sum, hn::Max(count, one))), d, &tile.blocker[k]);
  }
}

void Filter(const ShadowMap& map, const SamplePattern& pattern, const Turns& turns, float scale, Tile& tile) {
  const Floats d;
  const VF zero = hn::Zero(d), one = hn::Set(d, 1.0f);
  for (int k = 0; k < tile.size(); k += int(hn::Lanes(d))) {
    const VF depth = hn::LoadU(d, &tile.depth[k]), blocker = hn::LoadU(d, &tile.blocker[k]);
    const MF some = hn::Gt(blocker, zero);
    VF closer = zero;
    if (!hn::AllFalse(d, some)) {
      const VF width =
          RegionWidth(map.view, hn::IfThenElse(some, blocker, one), hn::IfThenElse(some, depth, one), scale);
      const VF limit = BlockingDepth(depth, hn::LoadU(d, &tile.rise[k]), width);
      ForSamples(map, pattern.kind, pattern.filter, hn::LoadU(d, &tile.x[k]), hn::LoadU(d, &tile.y[k]), width,
                 hn::LoadU(d, &turns.u[k]), hn::LoadU(d, &turns.v[k]),
                 [&](VF z) HWY_ATTR { closer = hn::Add(closer, hn::IfThenElseZero(hn::Lt(z, limit), one)); });
    }
    const VF share = hn::Div(closer, hn::Set(d, float(pattern.filter.size())));
    hn::StoreU(hn::Sub(one, hn::IfThenElseZero(some, share)), d, &tile.visibility[k]);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace penumbra::pcss_rotated
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace penumbra::pcss_rotated {

HWY_EXPORT(FindBlockers);
HWY_EXPORT(Filter);

void find_blockers(const ShadowMap& map, const SamplePattern& pattern, const Turns& turns, Tile& tile) {
  HWY_DYNAMIC_DISPATCH(FindBlockers)(map, pattern, turns, tile);
}
void filter(const ShadowMap& map, const SamplePattern& pattern, const Turns& turns, float scale, Tile& tile) {
  HWY_DYNAMIC_DISPATCH(Filter)(map, pattern, turns, scale, tile);
}

}  // namespace penumbra::pcss_rotated
#endif  // HWY_ONCE
