#include "techniques/bases/spherical_harmonics/kernel.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "techniques/bases/spherical_harmonics/kernel.cpp"
#include <hwy/foreach_target.h>  // IWYU pragma: keep

#include "techniques/bases/spherical_harmonics/basis.h"
#include "techniques/bases/spherical_harmonics/lanes-inl.h"
#include "techniques/bases/spherical_harmonics/straight_line.h"

HWY_BEFORE_NAMESPACE();
namespace penumbra::sh {
namespace HWY_NAMESPACE {

/// Vectors from rows of a batch; the last ones may be part filled.
template <int size>
HWY_INLINE void LoadRows(const float* rows, int k, int count, int stride, Lanes* out) {
  const Floats d;
  const auto left = std::size_t(count - k);
  for (int i = 0; i < size; ++i) {
    const float* at = rows + std::size_t(i) * stride + k;
    out[i] = left >= hn::Lanes(d) ? hn::LoadU(d, at) : hn::MaskedLoad(hn::FirstN(d, left), d, at);
  }
}

template <int size>
HWY_INLINE void StoreRows(const Lanes* values, int k, int count, int stride, float* rows) {
  const Floats d;
  const auto left = std::size_t(count - k);
  for (int i = 0; i < size; ++i) {
    float* at = rows + std::size_t(i) * stride + k;
    if (left >= hn::Lanes(d)) hn::StoreU(values[i].v, d, at);
    else hn::BlendedStore(values[i].v, hn::FirstN(d, left), d, at);
  }
}

template <int order>
HWY_NOINLINE void EvaluateOrder(const float* const direction[3], int count, float* y, int stride) {
  constexpr int size = coefficients(order);
  for (int k = 0; k < count; k += int(hn::Lanes(Floats()))) {
    Lanes w[3], out[size];
    for (int c = 0; c < 3; ++c) LoadRows<1>(direction[c], k, count, 0, w + c);
    evaluate<order>(w[0], w[1], w[2], out);
    StoreRows<size>(out, k, count, stride, y);
  }
}

template <int order>
HWY_NOINLINE void ProductOrder(const float* f, const float* g, int count, float* out, int stride) {
  constexpr int size = coefficients(order);
  for (int k = 0; k < count; k += int(hn::Lanes(Floats()))) {
    Lanes a[size], b[size], r[size];
    LoadRows<size>(f, k, count, stride, a);
    LoadRows<size>(g, k, count, stride, b);
    product<order>(a, b, r);
    StoreRows<size>(r, k, count, stride, out);
  }
}

template <int order>
HWY_NOINLINE void OneProduct(const float* f, const float* g, float* out) {
  constexpr int size = coefficients(order);
  const hn::CappedTag<float, 1> d;
  One a[size], b[size], r[size];
  for (int i = 0; i < size; ++i) a[i] = hn::LoadU(d, f + i), b[i] = hn::LoadU(d, g + i);
  product<order>(a, b, r);
  for (int i = 0; i < size; ++i) hn::StoreU(r[i].v, d, out + i);
}

void EvaluateBatch(int order, const float* const direction[3], int count, float* y, int stride) {
  with_order<1, max_order>(order, [&](auto n) { EvaluateOrder<n>(direction, count, y, stride); });
}

void ProductBatch(int order, const float* f, const float* g, int count, float* out, int stride) {
  with_order<2, 6>(order, [&](auto n) { ProductOrder<n>(f, g, count, out, stride); });
}

void Product(int order, const float* f, const float* g, float* out) {
  with_order<2, 6>(order, [&](auto n) { OneProduct<n>(f, g, out); });
}

const char* Target() {
  return hwy::TargetName(HWY_TARGET);
}

}  // namespace HWY_NAMESPACE
}  // namespace penumbra::sh
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace penumbra::sh {

HWY_EXPORT(EvaluateBatch);
HWY_EXPORT(ProductBatch);
HWY_EXPORT(Product);
HWY_EXPORT(Target);

void evaluate_batch(int order, const float* const direction[3], int count, float* y, int stride) {
  HWY_DYNAMIC_DISPATCH(EvaluateBatch)(order, direction, count, y, stride);
}

void product_batch(int order, const float* f, const float* g, int count, float* out, int stride) {
  HWY_DYNAMIC_DISPATCH(ProductBatch)(order, f, g, count, out, stride);
}

void product(int order, const float* f, const float* g, float* out) {
  HWY_DYNAMIC_DISPATCH(Product)(order, f, g, out);
}

std::string target() {
  return HWY_DYNAMIC_DISPATCH(Target)();
}

}  // namespace penumbra::sh
#endif  // HWY_ONCE
