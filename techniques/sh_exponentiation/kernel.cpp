#include "techniques/sh_exponentiation/kernel.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "techniques/sh_exponentiation/kernel.cpp"
#include <hwy/foreach_target.h>  // IWYU pragma: keep

#include <hwy/contrib/math/math-inl.h>

#include "scenes/cube_map.h"
#include "techniques/bases/spherical_harmonics/basis.h"
#include "techniques/bases/spherical_harmonics/lanes-inl.h"
#include "techniques/bases/spherical_harmonics/straight_line.h"

HWY_BEFORE_NAMESPACE();
namespace penumbra::sh_exponentiation {
namespace HWY_NAMESPACE {
using namespace penumbra::sh::HWY_NAMESPACE;  // NOLINT: the basis of the same instruction set
namespace hn = hwy::HWY_NAMESPACE;

using VF = hn::Vec<Floats>;
using VI = hn::Vec<hn::RebindToSigned<Floats>>;
using MF = hn::Mask<Floats>;

/// As many receivers as a vector holds; those beyond the last repeat it.
struct Group {
  VF x[3], normal[3];
  MF on_occluder;
};

HWY_INLINE VF Dot(const VF* a, const VF* b) {
  return hn::MulAdd(a[2], b[2], hn::MulAdd(a[1], b[1], hn::Mul(a[0], b[0])));
}

/// shadow_of() for many receivers. Returns the share, 0 where nothing is blocked.
HWY_INLINE VF ShadowOf(const Sphere& sphere, const Group& g, bool replace, VF* axis, VF* cosine) {
  const Floats d;
  const VF zero = hn::Zero(d), one = hn::Set(d, 1.0f), tiny = hn::Set(d, 1e-30f);
  VF radius = hn::Set(d, sphere.radius), share = one;
  VF to[3];
  for (int c = 0; c < 3; ++c) to[c] = hn::Sub(hn::Set(d, sphere.centre[c]), g.x[c]);
  const VF h = Dot(g.normal, to), square = Dot(to, to);
  const MF gone = hn::Le(h, hn::Neg(radius)), inside = hn::Le(square, hn::Mul(radius, radius));
  const MF own = hn::And(inside, hn::Or(g.on_occluder, hn::Lt(h, zero)));
  if (replace) {
    const VF resting = hn::Mul(hn::Set(d, 0.5f), hn::Add(radius, h));
    const MF pokes = hn::Lt(h, radius);
    share = hn::IfThenElse(hn::Lt(h, zero), hn::Div(hn::Add(radius, h), radius), one);
    const VF lift = hn::IfThenElseZero(pokes, hn::Sub(resting, h));
    for (int c = 0; c < 3; ++c) to[c] = hn::MulAdd(lift, g.normal[c], to[c]);
    radius = hn::IfThenElse(pokes, resting, radius);
  }
  const VF distance = hn::Sqrt(hn::Max(replace ? Dot(to, to) : square, tiny));
  const VF inverse = hn::Div(one, distance), sine = hn::Mul(radius, inverse);
  *cosine = hn::Sqrt(hn::Max(zero, hn::NegMulAdd(sine, sine, one)));
  *cosine = hn::IfThenZeroElse(inside, *cosine);
  for (int c = 0; c < 3; ++c) axis[c] = hn::IfThenElse(inside, g.normal[c], hn::Mul(to[c], inverse));
  return hn::IfThenZeroElse(hn::Or(gone, own), hn::IfThenElse(inside, one, share));
}

/// f += logarithm of the visibility behind one sphere: table rows between their samples, times the basis at the axis.
template <int order>
HWY_INLINE void AddLogarithm(const LogTable& table, const WeightedSphere& sphere, VF share, const VF* axis, VF cosine,
                             Lanes* f) {
  const Floats d;
  const hn::RebindToSigned<Floats> di;
  const VF at = hn::Mul(hn::Sub(hn::Set(d, 1.0f), cosine), hn::Set(d, float(LogTable::samples - 1)));
  const VI row = hn::Min(hn::ConvertTo(di, at), hn::Set(di, LogTable::samples - 2));
  const VF part = hn::Sub(at, hn::ConvertTo(d, row));
  const VI first = hn::Mul(row, hn::Set(di, order));
  Lanes y[order * order];
  sh::HWY_NAMESPACE::evaluate<order>(Lanes(axis[0]), Lanes(axis[1]), Lanes(axis[2]), y);
  const float* rows = table.rows().data();
  for (int l = 0; l < order; ++l) {
    const VF low = hn::GatherIndex(d, rows + l, first), high = hn::GatherIndex(d, rows + order + l, first);
    const VF zonal = hn::Mul(hn::MulAdd(part, hn::Sub(high, low), low), hn::Mul(share, hn::Set(d, sphere.weight[l])));
    for (int i = sh::index(l, -l); i <= sh::index(l, l); ++i) f[i] = multiply_add(Lanes(zonal), y[i], f[i]);
  }
}

HWY_INLINE VF LookUp(const std::vector<float>& values, VF at) {
  const Floats d;
  const hn::RebindToSigned<Floats> di;
  const VI k = hn::Min(hn::ConvertTo(di, at), hn::Set(di, int(values.size()) - 2));
  const VF low = hn::GatherIndex(d, values.data(), k), high = hn::GatherIndex(d, values.data() + 1, k);
  return hn::MulAdd(hn::Sub(at, hn::ConvertTo(d, k)), hn::Sub(high, low), low);
}

template <int order>
HWY_INLINE VF Norm(const Lanes* f) {
  VF sum = hn::Zero(Floats());
  for (int i = 1; i < order * order; ++i) sum = hn::MulAdd(f[i].v, f[i].v, sum);
  return hn::Sqrt(sum);
}

constexpr float root_4pi = 3.5449077018110318f;

/// f -> e^dc (a 1 + b f), f scaled by `scale` first.
template <int order>
HWY_INLINE void OptimalLinear(const LinearFit& fit, VF dc, VF norm, VF scale, Lanes* f) {
  const Floats d;
  const VF last = hn::Set(d, float(fit.a.size() - 1));
  const VF at = hn::Min(hn::Mul(norm, hn::Set(d, float(1.0 / fit.step))), last);
  const VF e = hn::Exp(d, dc);
  const VF b = hn::Mul(hn::Mul(e, scale), LookUp(fit.b, at));
  f[0] = hn::Mul(hn::Mul(e, LookUp(fit.a, at)), hn::Set(d, root_4pi));
  for (int i = 1; i < order * order; ++i) f[i] = hn::Mul(b, f[i].v);
}

/// Thousands of instructions: not for every caller anew.
template <int order>
HWY_NOINLINE void Square(const Lanes* f, Lanes* out) {
  square<order>(f, out);
}
template <int order>
HWY_NOINLINE void Product(const Lanes* f, const Lanes* g, Lanes* out) {
  product<order>(f, g, out);
}

template <int order>
HWY_NOINLINE void Hybrid(const Job& job, VF dc, Lanes* f) {
  const Floats d;
  const VF tau = hn::Set(d, float(job.method.tau)), half = hn::Set(d, 0.5f), huge = hn::Set(d, 1e30f);
  VF norm = Norm<order>(f), scale = hn::Set(d, 1.0f), squarings = hn::Zero(d);
  float most = 0.0f;
  for (;; ++most) {
    const MF above = hn::And(hn::Gt(norm, tau), hn::Lt(norm, huge));
    if (hn::AllFalse(d, above)) break;
    norm = hn::IfThenElse(above, hn::Mul(norm, half), norm);
    scale = hn::IfThenElse(above, hn::Mul(scale, half), scale);
    squarings = hn::IfThenElse(above, hn::Add(squarings, hn::Set(d, 1.0f)), squarings);
  }
  OptimalLinear<order>(*job.fit, hn::Mul(dc, scale), norm, scale, f);
  for (; most > 0.0f; --most) {
    const MF now = hn::Ge(squarings, hn::Set(d, most));
    Lanes squared[order * order];
    Square<order>(f, squared);
    for (int i = 0; i < order * order; ++i) f[i] = hn::IfThenElse(now, squared[i].v, f[i].v);
  }
}

/// g <- 1 + f (1 + f / 2 (1 + ... f / terms)) applied to g: a Taylor series of exp(M_f), from the left.
template <int order>
HWY_INLINE void Series(const Lanes* f, int terms, Lanes* g) {
  constexpr int size = order * order;
  Lanes sum[size], next[size];
  for (int i = 0; i < size; ++i) sum[i] = g[i];
  for (int k = terms; k >= 1; --k) {
    Product<order>(f, sum, next);
    for (int i = 0; i < size; ++i) sum[i] = multiply_add(next[i], Lanes(1.0 / k), g[i]);
  }
  for (int i = 0; i < size; ++i) g[i] = sum[i];
}

template <int order>
HWY_NOINLINE void PowerSeries(const Job& job, VF dc, Lanes* f) {
  const Floats d;
  Lanes g[order * order];
  for (Lanes& value : g) value = hn::Zero(d);
  g[0] = hn::Set(d, root_4pi);
  Series<order>(f, job.method.terms, g);
  const VF e = hn::Exp(d, dc);
  for (int i = 0; i < order * order; ++i) f[i] = hn::Mul(e, g[i].v);
}

/// exp(M) 1 = exp(M / s) ... exp(M / s) 1 with |M / s| <= 1, where ten terms of the series are exact to rounding.
template <int order>
HWY_NOINLINE void Exact(VF dc, Lanes* f) {
  const Floats d;
  constexpr int size = order * order;
  VF bound = hn::Zero(d);  // of |f(w)| for every w, and so of |M_f|
  for (int l = 1; l < order; ++l) {
    VF band = hn::Zero(d);
    for (int i = sh::index(l, -l); i <= sh::index(l, l); ++i) band = hn::MulAdd(f[i].v, f[i].v, band);
    bound = hn::MulAdd(hn::Sqrt(band), hn::Set(d, float(std::sqrt((2 * l + 1) / (4 * pi)))), bound);
  }
  const VF finite = hn::IfThenElseZero(hn::Lt(bound, hn::Set(d, 1e4f)), bound);
  const VF steps = hn::Max(hn::Set(d, 1.0f), hn::Ceil(finite)), share = hn::Div(hn::Set(d, 1.0f), steps);
  const VF e = hn::Exp(d, hn::Mul(dc, share));
  Lanes g[size];
  for (int i = 0; i < size; ++i) {
    f[i] = hn::Mul(f[i].v, share);
    g[i] = hn::Zero(d);
  }
  g[0] = hn::Set(d, root_4pi);
  const float most = hn::GetLane(hn::MaxOfLanes(d, steps));
  for (float step = 0.0f; step < most; ++step) {
    Lanes next[size];
    for (int i = 0; i < size; ++i) next[i] = g[i];
    Series<order>(f, 10, next);
    const MF now = hn::Lt(hn::Set(d, step), steps);
    for (int i = 0; i < size; ++i) g[i] = hn::IfThenElse(now, hn::Mul(e, next[i].v), g[i].v);
  }
  for (int i = 0; i < size; ++i) f[i] = g[i];
}

/// exp*(f), in place.
template <int order>
HWY_INLINE void Exponentiate(const Job& job, Lanes* f) {
  const Floats d;
  const VF dc = hn::Mul(f[0].v, hn::Set(d, 1.0f / root_4pi));
  f[0] = hn::Zero(d);
  switch (job.method.kind) {
    case Exponential::optimal_linear:
      return OptimalLinear<order>(*job.fit, dc, Norm<order>(f), hn::Set(d, 1.0f), f);
    case Exponential::hybrid:
      return Hybrid<order>(job, dc, f);
    case Exponential::power_series:
      return PowerSeries<order>(job, dc, f);
    case Exponential::exact:
      return Exact<order>(dc, f);
  }
}

/// The cosine lobe about the normals.
template <int order>
HWY_INLINE void CosineLobe(const Job& job, const VF* normal, Lanes* lobe) {
  sh::HWY_NAMESPACE::evaluate<order>(Lanes(normal[0]), Lanes(normal[1]), Lanes(normal[2]), lobe);
  for (int l = 0; l < order; ++l) {
    const auto factor = Lanes(double(job.lobe[l]));
    for (int i = sh::index(l, -l); i <= sh::index(l, l); ++i) lobe[i] = factor * lobe[i];
  }
}

template <int order>
HWY_INLINE Lanes Dot(const float* light, const Lanes* g) {
  Lanes sum = Lanes(double(light[0])) * g[0];
  for (int i = 1; i < order * order; ++i) sum = multiply_add(Lanes(double(light[i])), g[i], sum);
  return sum;
}

/// Reflected radiance at albedo 1, by channel, and what would arrive without an occluder.
template <int order>
HWY_INLINE void Reflect(const Job& job, const Group& group, const Lanes* visibility, Lanes* radiance,
                        Lanes* unshadowed) {
  constexpr int size = order * order;
  Lanes lobe[size], reflected[size];
  CosineLobe<order>(job, group.normal, lobe);
  Product<order>(visibility, lobe, reflected);
  for (int c = 0; c < 3; ++c) {
    radiance[c] = Dot<order>(job.light[c].data(), reflected) * Lanes(1.0 / pi);
    unshadowed[c] = Dot<order>(job.light[c].data(), lobe) * Lanes(1.0 / pi);
  }
}

/// The same through the table of L * H over normals: a receiver at a time.
template <int order>
HWY_INLINE void ReflectByTable(const Job& job, std::span<const int> which, const Lanes* visibility, Lanes* radiance,
                               Lanes* unshadowed) {
  const Floats d;
  constexpr int size = order * order;
  HWY_ALIGN float stored[size][hn::MaxLanes(Floats())], sums[6][hn::MaxLanes(Floats())] = {};
  for (int i = 0; i < size; ++i) hn::Store(visibility[i].v, d, stored[i]);
  for (std::size_t k = 0; k < which.size(); ++k) {
    const int texel = cube_texel(job.receivers->normal[which[k]], job.normals);
    for (int c = 0; c < 3; ++c) {
      const float* row = job.by_normal.data() + std::size_t(texel * 3 + c) * size;
      for (int i = 0; i < size; ++i) sums[c][k] += row[i] * stored[i][k];
      sums[c][k] *= float(1.0 / pi);
      sums[3 + c][k] = row[0] * float(root_4pi / pi);
    }
  }
  for (int c = 0; c < 3; ++c) radiance[c] = hn::Load(d, sums[c]), unshadowed[c] = hn::Load(d, sums[3 + c]);
}

/// Clamps to [0, unshadowed], counts, and writes.
HWY_INLINE void Write(const Job& job, std::span<const int> which, const Lanes* radiance, const Lanes* unshadowed,
                      vec3* out) {
  const Floats d;
  HWY_ALIGN float value[3][hn::MaxLanes(Floats())], most[3][hn::MaxLanes(Floats())];
  for (int c = 0; c < 3; ++c) hn::Store(radiance[c].v, d, value[c]), hn::Store(unshadowed[c].v, d, most[c]);
  std::size_t non_finite = 0, clamped = 0;
  for (std::size_t k = 0; k < which.size(); ++k)
    for (int c = 0; c < 3; ++c) out[which[k]][c] = guarded(value[c][k], most[c][k], non_finite, clamped);
  for (const int i : which) out[i] *= job.receivers->albedo[i];
  if (non_finite > 0) job.counts->non_finite += non_finite;
  if (clamped > 0) job.counts->clamped += clamped;
}

HWY_INLINE Group LoadGroup(const Receivers& r, std::span<const int> which) {
  const Floats d;
  HWY_ALIGN float x[3][hn::MaxLanes(Floats())], normal[3][hn::MaxLanes(Floats())], own[hn::MaxLanes(Floats())];
  for (std::size_t k = 0; k < hn::Lanes(d); ++k) {
    const int i = which[std::min(k, which.size() - 1)];
    for (int c = 0; c < 3; ++c) x[c][k] = r.position[i][c], normal[c][k] = r.normal[i][c];
    own[k] = r.on_occluder[i] ? 1.0f : 0.0f;
  }
  Group g;
  for (int c = 0; c < 3; ++c) g.x[c] = hn::Load(d, x[c]), g.normal[c] = hn::Load(d, normal[c]);
  g.on_occluder = hn::Gt(hn::Load(d, own), hn::Zero(d));
  return g;
}

template <int order>
HWY_NOINLINE void ShadeGroup(const Job& job, std::span<const int> which, std::span<const WeightedSphere> spheres,
                             vec3* out) {
  const Floats d;
  const Group group = LoadGroup(*job.receivers, which);
  Lanes f[order * order];
  for (Lanes& value : f) value = hn::Zero(d);
  for (const WeightedSphere& sphere : spheres) {
    VF axis[3], cosine;
    const VF share = ShadowOf(sphere.sphere, group, job.replace && !sphere.bound, axis, &cosine);
    if (hn::AllFalse(d, hn::Gt(share, hn::Zero(d)))) continue;
    AddLogarithm<order>(*job.table, sphere, share, axis, cosine, f);
  }
  Exponentiate<order>(job, f);
  Lanes radiance[3], unshadowed[3];
  if (job.by_normal.empty()) Reflect<order>(job, group, f, radiance, unshadowed);
  else ReflectByTable<order>(job, which, f, radiance, unshadowed);
  Write(job, which, radiance, unshadowed, out);
}

void Shade(const Job& job, std::span<const int> which, std::span<const WeightedSphere> spheres, vec3* radiance) {
  const std::size_t lanes = hn::Lanes(Floats());
  sh::with_order<4, 6>(job.order, [&](auto n) {
    for (std::size_t k = 0; k < which.size(); k += lanes)
      ShadeGroup<n>(job, which.subspan(k, std::min(lanes, which.size() - k)), spheres, radiance);
  });
}

const char* Target() {
  return hwy::TargetName(HWY_TARGET);
}

}  // namespace HWY_NAMESPACE
}  // namespace penumbra::sh_exponentiation
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace penumbra::sh_exponentiation {

HWY_EXPORT(Shade);
HWY_EXPORT(Target);

void shade(const Job& job, std::span<const int> which, std::span<const WeightedSphere> spheres, vec3* radiance) {
  HWY_DYNAMIC_DISPATCH(Shade)(job, which, spheres, radiance);
}

std::string target() {
  return HWY_DYNAMIC_DISPATCH(Target)();
}

}  // namespace penumbra::sh_exponentiation
#endif  // HWY_ONCE
