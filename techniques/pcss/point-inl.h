// Vectors whose lanes are receivers. Included once per instruction set by the kernels (Highway's -inl.h pattern).
#if defined(PENUMBRA_PCSS_POINT_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef PENUMBRA_PCSS_POINT_INL_H_
#undef PENUMBRA_PCSS_POINT_INL_H_
#else
#define PENUMBRA_PCSS_POINT_INL_H_
#endif

#include "techniques/pcss/region-inl.h"
#include "techniques/pcss/tile.h"

HWY_BEFORE_NAMESPACE();
namespace penumbra::pcss::simd {
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

}  // namespace HWY_NAMESPACE
}  // namespace penumbra::pcss::simd
HWY_AFTER_NAMESPACE();

#endif  // include guard
