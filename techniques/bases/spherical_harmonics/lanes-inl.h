// A vector of floats that behaves like a number, and the written-out spherical harmonics on it. Included once per
// instruction set by the kernels of techniques (Highway's -inl.h pattern).
#if defined(PENUMBRA_SH_LANES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef PENUMBRA_SH_LANES_INL_H_
#undef PENUMBRA_SH_LANES_INL_H_
#else
#define PENUMBRA_SH_LANES_INL_H_
#endif

#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace penumbra::sh {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

template <class D>
struct Number {
  hn::Vec<D> v;
  Number() = default;
  HWY_INLINE Number(hn::Vec<D> value) : v(value) {}  // NOLINT: a number is its vector
  HWY_INLINE explicit Number(double value) : v(hn::Set(D(), float(value))) {}
};
template <class D>
HWY_INLINE Number<D> operator+(Number<D> a, Number<D> b) {
  return hn::Add(a.v, b.v);
}
template <class D>
HWY_INLINE Number<D> operator-(Number<D> a, Number<D> b) {
  return hn::Sub(a.v, b.v);
}
template <class D>
HWY_INLINE Number<D> operator*(Number<D> a, Number<D> b) {
  return hn::Mul(a.v, b.v);
}
template <class D>
HWY_INLINE Number<D> multiply_add(Number<D> a, Number<D> b, Number<D> c) {
  return hn::MulAdd(a.v, b.v, c.v);
}

/// For single numbers: fused where the instruction set can.
HWY_INLINE float multiply_add(float a, float b, float c) {
#if HWY_ARCH_X86 && HWY_TARGET <= HWY_AVX2
  return __builtin_fmaf(a, b, c);
#else
  return a * b + c;
#endif
}

#define PENUMBRA_SH_INLINE HWY_INLINE
#define PENUMBRA_SH_PRODUCT HWY_INLINE
#include "generated/spherical_harmonics.inc"
#undef PENUMBRA_SH_INLINE
#undef PENUMBRA_SH_PRODUCT

using Floats = hn::ScalableTag<float>;
using Lanes = Number<Floats>;  ///< as many receivers (or directions) as a vector holds

}  // namespace HWY_NAMESPACE
}  // namespace penumbra::sh
HWY_AFTER_NAMESPACE();

#endif  // include guard
