// Vectors whose lanes are receivers. Included once per instruction set by the kernels (Highway's -inl.h pattern).
#if defined(PENUMBRA_SHADOW_MAP_POINT_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef PENUMBRA_SHADOW_MAP_POINT_INL_H_
#undef PENUMBRA_SHADOW_MAP_POINT_INL_H_
#else
#define PENUMBRA_SHADOW_MAP_POINT_INL_H_
#endif

#include "techniques/bases/shadow_map/region-inl.h"
#include "techniques/bases/shadow_map/shadow_map.h"

HWY_BEFORE_NAMESPACE();
namespace penumbra::shadow_map::simd {
namespace HWY_NAMESPACE {

using Floats = hn::CappedTag<float, Tile::padding>;
using Ints = hn::RebindToSigned<Floats>;
using VF = hn::Vec<Floats>;
using VI = hn::Vec<Ints>;
using MF = hn::Mask<Floats>;

HWY_INLINE VI FloorInt(VF v) {
  return hn::ConvertTo(Ints(), hn::Floor(v));
}
HWY_INLINE VI CeilInt(VF v) {
  return hn::ConvertTo(Ints(), hn::Ceil(v));
}
HWY_INLINE VI SetInt(int v) {
  return hn::Set(Ints(), v);
}

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

}  // namespace HWY_NAMESPACE
}  // namespace penumbra::shadow_map::simd
HWY_AFTER_NAMESPACE();

#endif  // include guard
