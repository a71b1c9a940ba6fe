// Evaluation and products written out for each order, for plain numbers: evaluate<order>(x, y, z, out),
// product<order>(f, g, out), square<order>(f, out). The text is made by generate.cpp when the project is built;
// lanes-inl.h has it for vectors.
#pragma once

#include <type_traits>
#include <utility>

#include "techniques/bases/spherical_harmonics/basis.h"

namespace penumbra::sh {

template <class T>
PENUMBRA_HD inline T multiply_add(T a, T b, T c) {
  return a * b + c;
}

#define PENUMBRA_SH_INLINE PENUMBRA_HD inline
#define PENUMBRA_SH_PRODUCT PENUMBRA_HD inline
#include "generated/spherical_harmonics.inc"
#undef PENUMBRA_SH_INLINE
#undef PENUMBRA_SH_PRODUCT

/// Calls f(std::integral_constant<int, order>) for a run-time order in [low, high]; Throws Error for others.
template <int low, int high, class Call>
void with_order(int order, Call call) {
  check_order(order, low, high);
  [&]<int... k>(std::integer_sequence<int, k...>) {
    ((order == low + k ? call(std::integral_constant<int, low + k>{}) : void()), ...);
  }
  (std::make_integer_sequence<int, high - low + 1>{});
}

/// All order^2 basis functions in a unit direction.
template <int order, class T>
PENUMBRA_HD inline void evaluate(const glm::vec<3, T>& direction, T* out) {
  evaluate<order, T>(direction.x, direction.y, direction.z, out);
}

}  // namespace penumbra::sh
