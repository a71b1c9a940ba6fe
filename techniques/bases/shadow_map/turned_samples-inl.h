// placed() on vectors. Included once per instruction set by the kernels (Highway's -inl.h pattern).
#if defined(PENUMBRA_SHADOW_MAP_TURNED_SAMPLES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef PENUMBRA_SHADOW_MAP_TURNED_SAMPLES_INL_H_
#undef PENUMBRA_SHADOW_MAP_TURNED_SAMPLES_INL_H_
#else
#define PENUMBRA_SHADOW_MAP_TURNED_SAMPLES_INL_H_
#endif

#include "techniques/bases/shadow_map/point-inl.h"
#include "techniques/bases/shadow_map/turned_samples.h"

HWY_BEFORE_NAMESPACE();
namespace penumbra::shadow_map::simd {
namespace HWY_NAMESPACE {

/// Places one sample for every lane's receiver.
HWY_INLINE void Place(Pattern kind, vec2 sample, VF u, VF v, VF& x, VF& y) {
  const Floats d;
  const VF sx = hn::Set(d, sample.x), sy = hn::Set(d, sample.y), half = hn::Set(d, 0.5f);
  if (kind == Pattern::lattice) {
    x = hn::Add(sx, u), y = hn::Add(sy, v);
    x = hn::Sub(hn::Sub(x, hn::Floor(x)), half), y = hn::Sub(hn::Sub(y, hn::Floor(y)), half);
  } else {
    x = hn::Sub(hn::Mul(u, sx), hn::Mul(v, sy)), y = hn::Add(hn::Mul(v, sx), hn::Mul(u, sy));
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace penumbra::shadow_map::simd
HWY_AFTER_NAMESPACE();

#endif  // include guard
