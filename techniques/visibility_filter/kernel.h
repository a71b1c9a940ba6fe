// Rows of pixels filtered by words of bits, with the instructions that count bits where the processor has them.
#pragma once

#include "techniques/visibility_filter/adaptive.h"
#include "techniques/visibility_filter/surface_bits.h"

namespace penumbra::visibility_filter {

/// radius_by_bits() and visibility_by_bits() of row y, whose pixels begin at `radius`, `visibility` and `to_eye`; that
/// is null where there is no eye. `map` is what the bits were made of.
void filter_row(const SurfaceBits& bits, const PixelMap& map, const float* to_eye, const Filtering& how, int y,
                std::uint8_t* radius, float* visibility);

/// box_by_bits() of row y.
void box_row(const SurfaceBits& bits, int r, int y, float* visibility);

}  // namespace penumbra::visibility_filter
