#include "techniques/shadow_map_traced/shadow_map_traced.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "techniques/shadow_map_traced/kernel.cpp"
#include <hwy/foreach_target.h>  // IWYU pragma: keep

#include "techniques/bases/shadow_map/turned_samples-inl.h"

HWY_BEFORE_NAMESPACE();
namespace penumbra::shadow_map_traced {
namespace HWY_NAMESPACE {
using namespace penumbra::shadow_map::simd::HWY_NAMESPACE;  // NOLINT: its base, for the same instruction set

/// Walk, a lane a receiver.
struct Walks {
  VF depth, surface, slope;
  MF hit;
};

/// step() on vectors.
HWY_INLINE void Step(const Walking& how, VF z, VF stored, Walks& walk) {
  const Floats d;
  const VF advance = hn::Sub(z, walk.depth), continued = hn::Add(walk.surface, hn::Mul(walk.slope, advance));
  const MF behind = hn::Gt(z, stored);
  const MF crossed = hn::Or(hn::Le(walk.depth, hn::Add(stored, hn::Set(d, how.thickness))), hn::Gt(z, continued));
  walk.hit = hn::Or(walk.hit, hn::And(behind, crossed));
  const VF change = hn::Sub(stored, walk.surface), most = hn::Mul(hn::Set(d, how.slope), advance);
  const MF both = hn::And(hn::Lt(hn::Abs(change), hn::Set(d, 3e38f)), hn::Gt(advance, hn::Zero(d)));
  const VF limited = hn::Max(hn::Min(change, most), hn::Neg(most));
  const VF slope = hn::IfThenElseZero(both, hn::Div(limited, advance));
  walk.slope = hn::IfThenElse(behind, walk.slope, slope);
  walk.surface = hn::IfThenElse(behind, continued, stored);
  walk.depth = z;
}

/// depth_at() on vectors.
HWY_INLINE VF DepthOf(const LightView& view, VF near, VF depth, VF f) {
  const Floats d;
  const VF one = hn::Set(d, 1.0f);
  if (!view.perspective) return hn::Sub(depth, hn::Mul(f, hn::Sub(depth, near)));
  const VF inverse = hn::Div(one, depth);
  return hn::Div(one, hn::Add(inverse, hn::Mul(f, hn::Sub(hn::Div(one, near), inverse))));
}

/// place_in_step() on vectors.
HWY_INLINE VF PlaceInStep(const Walking& how, int ray, VF random) {
  const Floats d;
  const VF turned = hn::Add(random, hn::Set(d, 0.61803399f * float(ray))), half = hn::Set(d, 0.5f);
  return hn::Add(half, hn::Mul(hn::Set(d, how.jitter), hn::Sub(hn::Sub(turned, hn::Floor(turned)), half)));
}

void WalkTile(const ShadowMap& map, const Walking& how, Pattern kind, const std::vector<vec2>& points,
              const Draws& draws, Tile& tile) {
  const Floats d;
  const VF zero = hn::Zero(d), one = hn::Set(d, 1.0f), near = hn::Set(d, map.view.near);
  const VF steps = hn::Set(d, float(how.steps)), nothing = hn::Set(d, std::numeric_limits<float>::infinity());
  for (int k = 0; k < tile.size(); k += int(hn::Lanes(d))) {
    const VF x = hn::LoadU(d, &tile.x[k]), y = hn::LoadU(d, &tile.y[k]), own = hn::LoadU(d, &tile.depth[k]);
    const MF below = hn::Gt(own, near);
    VF hits = zero;
    if (!hn::AllFalse(d, below)) {
      const VF depth = hn::IfThenElse(below, own, hn::Add(near, near));  // the other lanes walk too, for nothing
      const VF whole = RegionWidth(map.view, near, depth), stored = DepthAt(map, FloorInt(x), FloorInt(y));
      const VF u = hn::LoadU(d, &draws.turns.u[k]), v = hn::LoadU(d, &draws.turns.v[k]);
      const VF random = hn::LoadU(d, &draws.steps[k]);
      for (int ray = 0; ray < int(points.size()); ++ray) {
        VF px, py;
        Place(kind, points[std::size_t(ray)], u, v, px, py);
        const VF place = PlaceInStep(how, ray, random);
        Walks walk{near, nothing, zero, hn::Not(below)};
        for (int j = how.steps; j-- > 0 && !hn::AllTrue(d, walk.hit);) {
          const VF f = hn::Div(hn::Add(hn::Set(d, float(j)), place), steps), across = hn::Mul(f, whole);
          const VF at =
              DepthAt(map, FloorInt(hn::Add(x, hn::Mul(across, px))), FloorInt(hn::Add(y, hn::Mul(across, py))));
          Step(how, DepthOf(map.view, near, depth, f), at, walk);
        }
        Step(how, depth, stored, walk);
        hits = hn::Add(hits, hn::IfThenElseZero(hn::And(below, walk.hit), one));
      }
    }
    hn::StoreU(hn::Sub(one, hn::Div(hits, hn::Set(d, float(points.size())))), d, &tile.visibility[k]);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace penumbra::shadow_map_traced
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace penumbra::shadow_map_traced {

HWY_EXPORT(WalkTile);

void walk_tile(const ShadowMap& map, const Walking& how, Pattern kind, const std::vector<vec2>& points,
               const Draws& draws, Tile& tile) {
  HWY_DYNAMIC_DISPATCH(WalkTile)(map, how, kind, points, draws, tile);
}

}  // namespace penumbra::shadow_map_traced
#endif  // HWY_ONCE
