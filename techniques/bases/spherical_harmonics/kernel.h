// Vectorised evaluation and products, dispatched to the best instruction set at run time.
#pragma once

#include <string>

namespace penumbra::sh {

/// A batch keeps coefficient i of item k at [i * stride + k]; items [0, count) are read and written. Orders of products
/// are 2 to 6, of evaluation 1 to max_order; others throw Error.

/// y: order^2 rows, the basis in `count` unit directions given by coordinates.
void evaluate_batch(int order, const float* const direction[3], int count, float* y, int stride);

/// out = f * g, item by item. `out` may be f or g.
void product_batch(int order, const float* f, const float* g, int count, float* out, int stride);

/// One product: coefficients in a row.
void product(int order, const float* f, const float* g, float* out);

/// Name of the instruction set that these run on.
std::string target();

}  // namespace penumbra::sh
