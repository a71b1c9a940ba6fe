#include "techniques/ray_traced_denoised/ratio_filter.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "techniques/ray_traced_denoised/kernel.cpp"
#include <hwy/foreach_target.h>  // IWYU pragma: keep
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace penumbra::ray_traced_denoised {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Floats = hn::CappedTag<float, 16>;
using VF = hn::Vec<Floats>;

HWY_INLINE VF LoadRun(const std::uint8_t* run) {
  const hn::Rebind<std::int32_t, Floats> ints;
  return hn::ConvertTo(Floats(), hn::PromoteTo(ints, hn::LoadU(hn::Rebind<std::uint8_t, Floats>(), run)));
}

/// Stores the first `count` lanes: what lies beyond a row may be another thread's.
HWY_INLINE void StoreSome(VF v, int count, float* to) {
  const Floats d;
  if (count >= int(hn::Lanes(d))) return hn::StoreU(v, d, to);
  alignas(64) float lane[16];
  hn::Store(v, d, lane);
  for (int k = 0; k < count; ++k) to[k] = lane[k];
}

/// half_width()
HWY_INLINE VF HalfWidth(VF extent, VF density, float most) {
  const Floats d;
  const VF one = hn::Set(d, 1.0f), b = hn::Min(hn::Mul(extent, density), hn::Set(d, most));
  return hn::Mul(hn::Set(d, 0.5f), hn::Sub(hn::Max(b, one), one));
}

struct Means {
  VF seen, all;
};

/// box_mean(), a lane a pixel. Pixels beyond a lane's runs are loaded, but weigh nothing.
HWY_INLINE Means BoxMean(const float* seen, const float* all, std::ptrdiff_t step, VF half, VF before, VF after,
                         int before_most, int after_most) {
  const Floats d;
  const VF zero = hn::Zero(d), one = hn::Set(d, 1.0f);
  VF s = hn::LoadU(d, seen), u = hn::LoadU(d, all), weights = one;
  const float widest = hn::GetLane(hn::MaxOfLanes(d, half));
  for (int k = 1; float(k) < widest + 1.0f; ++k) {
    const VF at = hn::Set(d, float(k));
    const VF weight = hn::Min(hn::Max(hn::Sub(hn::Add(half, one), at), zero), one);
    const std::ptrdiff_t far = k * step;
    if (k <= after_most) {
      const VF w = hn::IfThenElseZero(hn::Le(at, after), weight);
      s = hn::Add(s, hn::Mul(w, hn::LoadU(d, seen + far)));
      u = hn::Add(u, hn::Mul(w, hn::LoadU(d, all + far)));
      weights = hn::Add(weights, w);
    }
    if (k <= before_most) {
      const VF w = hn::IfThenElseZero(hn::Le(at, before), weight);
      s = hn::Add(s, hn::Mul(w, hn::LoadU(d, seen - far)));
      u = hn::Add(u, hn::Mul(w, hn::LoadU(d, all - far)));
      weights = hn::Add(weights, w);
    }
  }
  return {hn::Div(s, weights), hn::Div(u, weights)};
}

void FilterRow(const SurfaceMap& map, const Plane& extent, float most, const Sums& in, int y, Sums& out) {
  const Floats d;
  const int lanes = int(hn::Lanes(d));
  const std::size_t row = std::size_t(y) * std::size_t(map.width);
  for (int x = 0; x < map.width; x += lanes) {
    const std::size_t i = row + std::size_t(x);
    const VF half = HalfWidth(hn::LoadU(d, extent.data() + i), hn::LoadU(d, map.across.data() + i), most);
    Means mean = {hn::LoadU(d, in.seen.data() + i), hn::LoadU(d, in.all.data() + i)};
    if (!hn::AllFalse(d, hn::Gt(half, hn::Zero(d))))
      mean = BoxMean(in.seen.data() + i, in.all.data() + i, 1, half, LoadRun(map.left.data() + i),
                     LoadRun(map.right.data() + i), longest_run, longest_run);
    StoreSome(mean.seen, map.width - x, out.seen.data() + i);
    StoreSome(mean.all, map.width - x, out.all.data() + i);
  }
}

void FilterColumns(const SurfaceMap& map, const Plane& extent, float most, const Sums& in, int y, Plane& share) {
  const Floats d;
  const int lanes = int(hn::Lanes(d));
  const VF zero = hn::Zero(d), one = hn::Set(d, 1.0f);
  const std::size_t row = std::size_t(y) * std::size_t(map.width);
  for (int x = 0; x < map.width; x += lanes) {
    const std::size_t i = row + std::size_t(x);
    const VF half = HalfWidth(hn::LoadU(d, extent.data() + i), hn::LoadU(d, map.along.data() + i), most);
    Means mean = {hn::LoadU(d, in.seen.data() + i), hn::LoadU(d, in.all.data() + i)};
    if (!hn::AllFalse(d, hn::Gt(half, zero)))
      mean = BoxMean(in.seen.data() + i, in.all.data() + i, map.width, half, LoadRun(map.up.data() + i),
                     LoadRun(map.down.data() + i), y, map.height - 1 - y);
    const auto any = hn::Gt(mean.all, zero);
    const VF ratio = hn::IfThenElse(any, hn::Div(mean.seen, hn::IfThenElse(any, mean.all, one)), one);
    StoreSome(ratio, map.width - x, share.data() + i);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace penumbra::ray_traced_denoised
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace penumbra::ray_traced_denoised::simd {

HWY_EXPORT(FilterRow);
HWY_EXPORT(FilterColumns);

void filter_row(const SurfaceMap& map, const Plane& extent, float most, const Sums& in, int y, Sums& out) {
  HWY_DYNAMIC_DISPATCH(FilterRow)(map, extent, most, in, y, out);
}
void filter_columns(const SurfaceMap& map, const Plane& extent, float most, const Sums& in, int y, Plane& share) {
  HWY_DYNAMIC_DISPATCH(FilterColumns)(map, extent, most, in, y, share);
}

}  // namespace penumbra::ray_traced_denoised::simd
#endif  // HWY_ONCE
