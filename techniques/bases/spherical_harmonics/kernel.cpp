#include "techniques/bases/spherical_harmonics/kernel.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "techniques/bases/spherical_harmonics/kernel.cpp"
#include <hwy/foreach_target.h>  // IWYU pragma: keep

#include <algorithm>
#include <utility>

#include "techniques/bases/spherical_harmonics/basis.h"
#include "techniques/bases/spherical_harmonics/lanes-inl.h"
#include "techniques/bases/spherical_harmonics/rotation.h"
#include "techniques/bases/spherical_harmonics/straight_line.h"

HWY_BEFORE_NAMESPACE();
namespace penumbra::sh {
namespace HWY_NAMESPACE {

template <int order>
HWY_NOINLINE void EvaluateOrder(const float* const direction[3], int count, float* y) {
  const Floats d;
  constexpr int size = coefficients(order);
  for (int first = 0; first < count; first += block, y += size * block)
    for (int k = 0; k < block; k += int(hn::Lanes(d))) {
      Lanes w[3], out[size];
      for (int c = 0; c < 3; ++c) w[c] = hn::LoadU(d, direction[c] + first + k);
      evaluate<order>(w[0], w[1], w[2], out);
      for (int i = 0; i < size; ++i) hn::StoreU(out[i].v, d, y + i * block + k);
    }
}

template <int order>
HWY_NOINLINE void ProductOrder(const float* f, const float* g, int count, float* out) {
  const Floats d;
  constexpr int size = coefficients(order);
  for (int first = 0; first < count; first += block, f += size * block, g += size * block, out += size * block)
    for (int k = 0; k < block; k += int(hn::Lanes(d))) {
      Lanes a[size], b[size], r[size];
      for (int i = 0; i < size; ++i) a[i] = hn::LoadU(d, f + i * block + k), b[i] = hn::LoadU(d, g + i * block + k);
      product<order>(a, b, r);
      for (int i = 0; i < size; ++i) hn::StoreU(r[i].v, d, out + i * block + k);
    }
}

template <int order>
HWY_NOINLINE void SquareOrder(const float* f, int count, float* out) {
  const Floats d;
  constexpr int size = coefficients(order);
  for (int first = 0; first < count; first += block, f += size * block, out += size * block)
    for (int k = 0; k < block; k += int(hn::Lanes(d))) {
      Lanes a[size], r[size];
      for (int i = 0; i < size; ++i) a[i] = hn::LoadU(d, f + i * block + k);
      square<order>(a, r);
      for (int i = 0; i < size; ++i) hn::StoreU(r[i].v, d, out + i * block + k);
    }
}

/// One band of a rotation: its entries stand in a row.
template <int l>
HWY_INLINE const float* RotateBand(const float* entry, const float* f, float* out) {
  const Floats d;
  constexpr int size = 2 * l + 1;
  Lanes c[size];
  for (int j = 0; j < size; ++j) c[j] = hn::LoadU(d, f + (l * l + j) * block);
  for (int i = 0; i < size; ++i, entry += size) {
    Lanes sum = Lanes(hn::Set(d, entry[0])) * c[0];
    for (int j = 1; j < size; ++j) sum = multiply_add(Lanes(hn::Set(d, entry[j])), c[j], sum);
    hn::StoreU(sum.v, d, out + (l * l + i) * block);
  }
  return entry;
}

template <int order>
HWY_NOINLINE void RotateOrder(const float* entries, const float* f, int count, float* out) {
  constexpr int size = coefficients(order);
  for (int first = 0; first < count; first += block, f += size * block, out += size * block)
    for (int k = 0; k < block; k += int(hn::Lanes(Floats()))) {
      const float* entry = entries;
      [&]<int... l>(std::integer_sequence<int, l...>) HWY_ATTR {
        ((entry = RotateBand<l>(entry, f + k, out + k)), ...);
      }
      (std::make_integer_sequence<int, order>());
    }
}

/// All t_ij = f_i g_j + f_j g_i, a row of vectors at a time; the rest is straight-line code on single numbers.
template <int order>
HWY_NOINLINE void OneProduct(const float* f, const float* g, float* out) {
  const Floats d;
  constexpr int size = coefficients(order), lanes = int(hn::MaxLanes(Floats())), blocks = (size + lanes - 1) / lanes;
  constexpr auto constant = float(0.28209479177387814);  // Y_0
  const auto rest = hn::FirstN(d, std::size_t(size - (blocks - 1) * lanes));
  hn::Vec<Floats> a[blocks], b[blocks];
  auto dot = hn::Zero(d);
  HWY_ALIGN float t[size * blocks * lanes], linear[blocks * lanes];
  for (int k = 0; k < blocks; ++k) {
    a[k] = k + 1 < blocks ? hn::LoadU(d, f + k * lanes) : hn::MaskedLoad(rest, d, f + k * lanes);
    b[k] = k + 1 < blocks ? hn::LoadU(d, g + k * lanes) : hn::MaskedLoad(rest, d, g + k * lanes);
    dot = hn::MulAdd(a[k], b[k], dot);
    hn::Store(hn::MulAdd(hn::Set(d, constant * f[0]), b[k], hn::Mul(hn::Set(d, constant * g[0]), a[k])), d,
              linear + k * lanes);
  }
  for (int i = 1; i < size; ++i) {
    const auto ai = hn::Set(d, f[i]), bi = hn::Set(d, g[i]);
    for (int k = i / lanes; k < blocks; ++k)
      hn::Store(hn::MulAdd(ai, b[k], hn::Mul(bi, a[k])), d, t + (i * blocks + k) * lanes);
  }
  contract<order, blocks * lanes>(t, linear);
  std::copy(linear + 1, linear + size, out + 1);
  out[0] = constant * hn::GetLane(hn::SumOfLanes(d, dot));
}

void EvaluateBatch(int order, const float* const direction[3], int count, float* y) {
  with_order<1, max_order>(order, [&](auto n) HWY_ATTR { EvaluateOrder<n>(direction, count, y); });
}

void ProductBatch(int order, const float* f, const float* g, int count, float* out) {
  with_order<2, 6>(order, [&](auto n) HWY_ATTR { ProductOrder<n>(f, g, count, out); });
}

void SquareBatch(int order, const float* f, int count, float* out) {
  with_order<2, 6>(order, [&](auto n) HWY_ATTR { SquareOrder<n>(f, count, out); });
}

void Product(int order, const float* f, const float* g, float* out) {
  with_order<2, 6>(order, [&](auto n) HWY_ATTR { OneProduct<n>(f, g, out); });
}

void RotateBatch(int order, const float* entries, const float* f, int count, float* out) {
  with_order<1, max_order>(order, [&](auto n) HWY_ATTR { RotateOrder<n>(entries, f, count, out); });
}

}  // namespace HWY_NAMESPACE
}  // namespace penumbra::sh
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace penumbra::sh {

HWY_EXPORT(EvaluateBatch);
HWY_EXPORT(ProductBatch);
HWY_EXPORT(SquareBatch);
HWY_EXPORT(Product);
HWY_EXPORT(RotateBatch);

void evaluate_batch(int order, const float* const direction[3], int count, float* y) {
  HWY_DYNAMIC_DISPATCH(EvaluateBatch)(order, direction, count, y);
}

void product_batch(int order, const float* f, const float* g, int count, float* out) {
  HWY_DYNAMIC_DISPATCH(ProductBatch)(order, f, g, count, out);
}

void square_batch(int order, const float* f, int count, float* out) {
  HWY_DYNAMIC_DISPATCH(SquareBatch)(order, f, count, out);
}

void product(int order, const float* f, const float* g, float* out) {
  HWY_DYNAMIC_DISPATCH(Product)(order, f, g, out);
}

void rotate_batch(const Rotation& rotation, const float* f, int count, float* out) {
  HWY_DYNAMIC_DISPATCH(RotateBatch)(rotation.order(), rotation.entries(), f, count, out);
}

}  // namespace penumbra::sh
#endif  // HWY_ONCE
