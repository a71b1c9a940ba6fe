// Vectorised evaluation and products, dispatched to the best instruction set at run time.
#pragma once

#include <cstddef>

namespace penumbra::sh {

/// A batch keeps items in blocks of 16: coefficient i of item k at [(k / 16 * order^2 + i) * 16 + k % 16], so that what
/// is read together lies together. Arrays have room for whole blocks; the last one is computed in full.
inline constexpr int block = 16;
inline std::size_t batch_floats(int order, int count) {
  return std::size_t((count + block - 1) / block) * block * std::size_t(order * order);
}

/// y: the basis in `count` unit directions, given by three arrays of whole blocks of coordinates. Order 1 to max_order.
void evaluate_batch(int order, const float* const direction[3], int count, float* y);

/// out = f * g, item by item, order 2 to 6. `out` may be f or g.
void product_batch(int order, const float* f, const float* g, int count, float* out);

/// out = f * f, item by item, for less. `out` may be f.
void square_batch(int order, const float* f, int count, float* out);

/// One product of order 2 to 6: coefficients in a row.
void product(int order, const float* f, const float* g, float* out);

}  // namespace penumbra::sh
