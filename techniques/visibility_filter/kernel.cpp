#include "techniques/visibility_filter/kernel.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "techniques/visibility_filter/kernel.cpp"
#include <hwy/foreach_target.h>  // IWYU pragma: keep

#include <hwy/highway.h>

#include "techniques/visibility_filter/chen_2016.h"

HWY_BEFORE_NAMESPACE();
namespace penumbra::visibility_filter {
namespace HWY_NAMESPACE {

// Flattened: what they call is plain code, and gets this target's instructions by being inlined.

HWY_FLATTEN void FilterRow(const SurfaceBits& bits, const PixelMap& map, const float* to_eye, const Filtering& how,
                           int y, std::uint8_t* radius, float* visibility) {
  const float *depth = map.depth.data(), *caster = map.caster.data();
  for (int x = 0; x < bits.width; ++x) {
    const int r = radius_by_bits(bits, depth, caster, x, y, to_eye ? to_eye[x] : 1.0f, how);
    radius[x] = std::uint8_t(r);
    visibility[x] = visibility_by_bits(bits, x, y, r);
  }
}

HWY_FLATTEN void BoxRow(const SurfaceBits& bits, int r, int y, float* visibility) {
  for (int x = 0; x < bits.width; ++x) visibility[x] = box_by_bits(bits, x, y, r);
}

}  // namespace HWY_NAMESPACE
}  // namespace penumbra::visibility_filter
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace penumbra::visibility_filter {

HWY_EXPORT(FilterRow);
HWY_EXPORT(BoxRow);

void filter_row(const SurfaceBits& bits, const PixelMap& map, const float* to_eye, const Filtering& how, int y,
                std::uint8_t* radius, float* visibility) {
  HWY_DYNAMIC_DISPATCH(FilterRow)(bits, map, to_eye, how, y, radius, visibility);
}

void box_row(const SurfaceBits& bits, int r, int y, float* visibility) {
  HWY_DYNAMIC_DISPATCH(BoxRow)(bits, r, y, visibility);
}

}  // namespace penumbra::visibility_filter
#endif  // HWY_ONCE
