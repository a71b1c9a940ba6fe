// LightView::region and texel_range on vectors. Included once per instruction set by the kernels (Highway's -inl.h
// pattern).
#if defined(PENUMBRA_SHADOW_MAP_REGION_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef PENUMBRA_SHADOW_MAP_REGION_INL_H_
#undef PENUMBRA_SHADOW_MAP_REGION_INL_H_
#else
#define PENUMBRA_SHADOW_MAP_REGION_INL_H_
#endif

#include <hwy/highway.h>

#include "techniques/bases/shadow_map/shadow_map.h"

HWY_BEFORE_NAMESPACE();
namespace penumbra::shadow_map::simd {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

template <class V>
HWY_INLINE V RegionWidth(const LightView& view, V z, V depth, float scale = 1.0f) {
  const hn::DFromV<V> d;
  const V one = hn::Set(d, 1.0f);
  const V span = view.perspective ? hn::Sub(hn::Div(one, z), hn::Div(one, depth)) : hn::Sub(depth, z);
  const V width = hn::Mul(hn::Set(d, view.spread), span);
  return hn::Min(hn::Max(hn::Mul(hn::Set(d, scale), width), hn::Zero(d)), hn::Set(d, float(view.resolution)));
}

/// blocking_depth() on vectors.
template <class V>
HWY_INLINE V BlockingDepth(V depth, V rise, V width) {
  const V most = hn::Mul(hn::Set(hn::DFromV<V>(), most_rise), depth);
  return hn::Sub(depth, hn::Min(hn::Mul(rise, width), most));
}

template <class V>
using IntsOf = hn::Vec<hn::Rebind<std::int32_t, hn::DFromV<V>>>;

template <class V>
HWY_INLINE void TexelRange(V centre, V width, IntsOf<V>& first, IntsOf<V>& last) {
  const hn::DFromV<V> d;
  const hn::Rebind<std::int32_t, hn::DFromV<V>> di;
  const V half = hn::Mul(hn::Set(d, 0.5f), width), middle = hn::Set(d, 0.5f);
  const auto one = hn::Set(di, 1);
  first = hn::ConvertTo(di, hn::Ceil(hn::Sub(hn::Sub(centre, half), middle)));
  last = hn::Add(hn::ConvertTo(di, hn::Floor(hn::Sub(hn::Add(centre, half), middle))), one);
  const auto own = hn::ConvertTo(di, hn::Floor(centre));
  const auto none = hn::Not(hn::Lt(first, last));
  first = hn::IfThenElse(none, own, first);
  last = hn::IfThenElse(none, hn::Add(own, one), last);
}

}  // namespace HWY_NAMESPACE
}  // namespace penumbra::shadow_map::simd
HWY_AFTER_NAMESPACE();

#endif  // include guard
