#include "techniques/shadow_map/hard_shadow.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "techniques/shadow_map/kernel.cpp"
#include <hwy/foreach_target.h>  // IWYU pragma: keep

#include "techniques/bases/shadow_map/point-inl.h"

HWY_BEFORE_NAMESPACE();
namespace penumbra::hard_shadow {
namespace HWY_NAMESPACE {
using namespace penumbra::shadow_map::simd::HWY_NAMESPACE;  // NOLINT: its base, for the same instruction set

void FilterTile(const ShadowMap& map, int kernel, Tile& tile) {
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

}  // namespace HWY_NAMESPACE
}  // namespace penumbra::hard_shadow
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace penumbra::hard_shadow {

HWY_EXPORT(FilterTile);

void filter_tile(const ShadowMap& map, int kernel, Tile& tile) {
  HWY_DYNAMIC_DISPATCH(FilterTile)(map, kernel, tile);
}

}  // namespace penumbra::hard_shadow
#endif  // HWY_ONCE
