#include "techniques/moment_shadows/moments.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "techniques/moment_shadows/kernel.cpp"
#include <hwy/foreach_target.h>  // IWYU pragma: keep

#include "techniques/bases/shadow_map/region-inl.h"

HWY_BEFORE_NAMESPACE();
namespace penumbra::moment_shadows {
namespace HWY_NAMESPACE {
using namespace penumbra::shadow_map::simd::HWY_NAMESPACE;  // NOLINT: its base, for the same instruction set

using Doubles = hn::CappedTag<double, Tile::padding>;
using Longs = hn::RebindToSigned<Doubles>;
using Floats = hn::Rebind<float, Doubles>;
using Ints = hn::Rebind<std::int32_t, Doubles>;
using VD = hn::Vec<Doubles>;
using VL = hn::Vec<Longs>;
using VF = hn::Vec<Floats>;

HWY_INLINE VD Set(double v) {
  return hn::Set(Doubles(), v);
}

struct Range {
  VL first, last;     ///< cut to the map
  VD length, inside;  ///< texels before and after that
};

/// texel_range, and what of it lies on the map.
HWY_INLINE Range MapRange(VF centre, VF width, int edge) {
  const Ints di;
  hn::Vec<Ints> first, last;
  TexelRange(centre, width, first, last);
  const auto zero = hn::Set(di, 0), end = hn::Set(di, edge);
  const auto cut_first = hn::Min(hn::Max(first, zero), end), cut_last = hn::Min(hn::Max(last, zero), end);
  const Doubles dd;
  return {hn::PromoteTo(Longs(), cut_first), hn::PromoteTo(Longs(), cut_last), hn::PromoteTo(dd, hn::Sub(last, first)),
          hn::PromoteTo(dd, hn::Sub(cut_last, cut_first))};
}

struct MeanPowers {
  VD b[4];
};

/// MomentTable::mean and biased().
HWY_INLINE MeanPowers MeanMoments(const MomentTable& table, VF x, VF y, VF width, double bias) {
  const Doubles d;
  const int edge = table.edge();
  const Range across = MapRange(x, width, edge), down = MapRange(y, width, edge);
  const VD count = hn::Mul(across.length, down.length);
  const VD outside = hn::Sub(count, hn::Mul(across.inside, down.inside));
  // Row starts by shifts and additions: 64-bit products are slow or missing.
  const auto row = [&](VL k) HWY_ATTR {
    const VD product = hn::Mul(hn::ConvertTo(d, k), Set(double(edge + 1)));
    return hn::ConvertTo(Longs(), product);
  };
  const VL top = row(down.first), bottom = row(down.last);
  MeanPowers out;
  for (int j = 0; j < 4; ++j) {
    const double* s = table.sums(j);
    const auto at = [&](VL r, VL c) HWY_ATTR { return hn::GatherIndex(d, s, hn::Add(r, c)); };
    const VD sum = hn::Sub(hn::Sub(at(bottom, across.last), at(bottom, across.first)),
                           hn::Sub(at(top, across.last), at(top, across.first)));
    const VD b = hn::Div(hn::Add(sum, outside), count);
    out.b[j] = hn::Add(b, hn::Mul(Set(bias), hn::Sub(Set(1.0 / (j + 2)), b)));
  }
  return out;
}

struct Found {
  VD share, mean;
};

/// blockers_of_moments().
HWY_INLINE Found BlockersOfMoments(const MeanPowers& m, VD z0) {
  const VD one = Set(1.0), zero = Set(0.0);
  const VD b0 = m.b[0], b1 = m.b[1];
  const VD d22 = hn::Sub(b1, hn::Mul(b0, b0)), l32d22 = hn::Sub(m.b[2], hn::Mul(b0, b1));
  const VD d33d22 = hn::Sub(hn::Mul(hn::Sub(m.b[3], hn::Mul(b1, b1)), d22), hn::Mul(l32d22, l32d22));
  const VD l32 = hn::Div(l32d22, d22);
  VD c1 = hn::Sub(z0, b0);
  VD c2 = hn::Sub(hn::Sub(hn::Mul(z0, z0), b1), hn::Mul(l32, c1));
  c1 = hn::Div(c1, d22);
  c2 = hn::Mul(c2, hn::Div(d22, d33d22));
  c1 = hn::Sub(c1, hn::Mul(l32, c2));
  const VD c0 = hn::Sub(one, hn::Add(hn::Mul(c1, b0), hn::Mul(c2, b1)));
  const VD p = hn::Div(c1, c2), q = hn::Div(c0, c2);
  const VD r = hn::Sqrt(hn::Max(zero, hn::Sub(hn::Mul(hn::Mul(Set(0.25), p), p), q)));
  const VD middle = hn::Mul(Set(-0.5), p), z1 = hn::Sub(middle, r), z2 = hn::Add(middle, r);
  const auto weight = [&](VD a, VD b, VD own) HWY_ATTR {  // of the depth `own` beside a and b
    const VD above = hn::Add(hn::Sub(hn::Mul(a, b), hn::Mul(b0, hn::Add(a, b))), b1);
    return hn::Div(above, hn::Mul(hn::Sub(own, a), hn::Sub(own, b)));
  };
  const VD w0 = weight(z1, z2, z0), w1 = weight(z0, z2, z1);
  const auto both = hn::Lt(z2, z0), first = hn::Lt(z1, z0);
  VD share = hn::IfThenElse(both, hn::Sub(one, w0), hn::IfThenElseZero(first, w1));
  const VD mean = hn::IfThenElse(both, hn::Div(hn::Sub(b0, hn::Mul(w0, z0)), hn::Sub(one, w0)), z1);
  share = hn::IfThenElseZero(hn::Gt(share, zero), hn::Min(share, one));
  return {share, mean};
}

HWY_INLINE VD Normalised(const MomentTable& table, VF z) {
  return hn::Mul(hn::Sub(hn::PromoteTo(Doubles(), z), Set(table.near())), Set(table.scale()));
}

void FindBlockers(const LightView& view, const MomentTable& table, double bias, Tile& tile) {
  const Floats d;
  const VF near = hn::Set(d, view.near), zero = hn::Zero(d);
  for (int k = 0; k < tile.size(); k += int(hn::Lanes(d))) {
    const VF depth = hn::LoadU(d, &tile.depth[k]);
    const auto open = hn::Gt(depth, near);
    VF blocker = zero;
    if (!hn::AllFalse(d, open)) {
      const VF width = RegionWidth(view, near, hn::Max(depth, near));
      const MeanPowers region = MeanMoments(table, hn::LoadU(d, &tile.x[k]), hn::LoadU(d, &tile.y[k]), width, bias);
      const VF limit = BlockingDepth(depth, hn::LoadU(d, &tile.rise[k]), width);
      const Found found = BlockersOfMoments(region, Normalised(table, limit));
      const VD z = hn::Add(Set(table.near()), hn::Div(found.mean, Set(table.scale())));
      const VF share = hn::DemoteTo(d, found.share);
      blocker = hn::IfThenElseZero(hn::And(open, hn::Gt(share, zero)), hn::Max(near, hn::DemoteTo(d, z)));
    }
    hn::StoreU(blocker, d, &tile.blocker[k]);
  }
}

void Filter(const LightView& view, const MomentTable& table, double bias, float scale, Tile& tile) {
  const Floats d;
  const VF zero = hn::Zero(d), one = hn::Set(d, 1.0f);
  for (int k = 0; k < tile.size(); k += int(hn::Lanes(d))) {
    const VF depth = hn::LoadU(d, &tile.depth[k]), blocker = hn::LoadU(d, &tile.blocker[k]);
    const auto some = hn::And(hn::Gt(blocker, zero), hn::Lt(blocker, depth));
    VF visibility = one;
    if (!hn::AllFalse(d, some)) {
      const VF width = RegionWidth(view, hn::IfThenElse(some, blocker, one), hn::IfThenElse(some, depth, one), scale);
      const MeanPowers region = MeanMoments(table, hn::LoadU(d, &tile.x[k]), hn::LoadU(d, &tile.y[k]), width, bias);
      const VF limit = BlockingDepth(depth, hn::LoadU(d, &tile.rise[k]), width);
      const Found found = BlockersOfMoments(region, Normalised(table, limit));
      visibility = hn::IfThenElse(some, hn::DemoteTo(d, hn::Sub(Set(1.0), found.share)), one);
    }
    hn::StoreU(visibility, d, &tile.visibility[k]);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace penumbra::moment_shadows
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace penumbra::moment_shadows {

HWY_EXPORT(FindBlockers);
HWY_EXPORT(Filter);

void find_blockers(const LightView& view, const MomentTable& table, double bias, Tile& tile) {
  HWY_DYNAMIC_DISPATCH(FindBlockers)(view, table, bias, tile);
}
void filter(const LightView& view, const MomentTable& table, double bias, float scale, Tile& tile) {
  HWY_DYNAMIC_DISPATCH(Filter)(view, table, bias, scale, tile);
}

}  // namespace penumbra::moment_shadows
#endif  // HWY_ONCE
