#include "techniques/sh_exponentiation/kernel.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "techniques/sh_exponentiation/kernel.cpp"
#include <hwy/foreach_target.h>  // IWYU pragma: keep

#include <hwy/contrib/math/math-inl.h>

#include "scenes/cube_map.h"
#include "techniques/bases/spherical_harmonics/basis.h"
#include "techniques/bases/spherical_harmonics/kernel.h"
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
  const VI row = hn::Max(hn::Zero(di), hn::Min(hn::ConvertTo(di, at), hn::Set(di, LogTable::samples - 2)));
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
  const VI k = hn::Max(hn::Zero(di), hn::Min(hn::ConvertTo(di, at), hn::Set(di, int(values.size()) - 2)));
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

/// Sixteen receivers, [coefficient][receiver]: what the batched products take. Their code is compiled once, there.
template <int order>
struct Block {
  static constexpr int size = order * order;
  HWY_ALIGN float values[size * sh::block];

  HWY_INLINE void Load(int k, Lanes* f) const {
    for (int i = 0; i < size; ++i) f[i] = hn::Load(Floats(), values + i * sh::block + k);
  }
  HWY_INLINE void Store(int k, const Lanes* f) {
    for (int i = 0; i < size; ++i) hn::Store(f[i].v, Floats(), values + i * sh::block + k);
  }
};

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

/// How often |f| must be halved until it is no more than tau; halves norm and scale as often.
HWY_INLINE VF Halve(float tau, VF& norm, VF& scale) {
  const Floats d;
  const VF limit = hn::Set(d, tau), half = hn::Set(d, 0.5f), huge = hn::Set(d, 1e30f);
  VF count = hn::Zero(d);
  for (;;) {
    const MF above = hn::And(hn::Gt(norm, limit), hn::Lt(norm, huge));
    if (hn::AllFalse(d, above)) return count;
    norm = hn::IfThenElse(above, hn::Mul(norm, half), norm);
    scale = hn::IfThenElse(above, hn::Mul(scale, half), scale);
    count = hn::IfThenElse(above, hn::Add(count, hn::Set(d, 1.0f)), count);
  }
}

/// Takes new values where `step` is still within a receiver's number of steps.
template <int order>
HWY_INLINE void TakeWithin(float step, const float* steps, const Block<order>& fresh, Block<order>& out) {
  const Floats d;
  for (int k = 0; k < sh::block; k += int(hn::Lanes(d))) {
    const MF now = hn::Lt(hn::Set(d, step), hn::Load(d, steps + k));
    for (int i = k; i < Block<order>::size * sh::block; i += sh::block)
      hn::Store(hn::IfThenElse(now, hn::Load(d, fresh.values + i), hn::Load(d, out.values + i)), d, out.values + i);
  }
}

/// optimal-linear, or halved before and squared after as often as tau asks (`halve`).
template <int order>
HWY_INLINE void Linear(const Job& job, bool halve, const float* dc, Block<order>& f) {
  const Floats d;
  HWY_ALIGN float halvings[sh::block] = {};
  for (int k = 0; k < sh::block; k += int(hn::Lanes(d))) {
    Lanes part[order * order];
    f.Load(k, part);
    VF norm = Norm<order>(part), scale = hn::Set(d, 1.0f);
    if (halve) hn::Store(Halve(float(job.method.tau), norm, scale), d, halvings + k);
    OptimalLinear<order>(*job.fit, hn::Mul(hn::Load(d, dc + k), scale), norm, scale, part);
    f.Store(k, part);
  }
  // A receiver with few halvings waits for its turn: all end together.
  const float most = *std::max_element(halvings, halvings + sh::block);
  Block<order> squared;
  for (float left = most - 1.0f; left >= 0.0f; --left) {
    sh::square_batch(order, f.values, sh::block, squared.values);
    TakeWithin<order>(left, halvings, squared, f);
  }
}

/// g <- 1 + f (1 + f / 2 (1 + ... f / terms)) applied to g: a Taylor series of exp(M_f), from the left.
template <int order>
HWY_INLINE void Series(const Block<order>& f, int terms, Block<order>& g) {
  const Floats d;
  Block<order> sum = g, next;
  for (int term = terms; term >= 1; --term) {
    sh::product_batch(order, f.values, sum.values, sh::block, next.values);
    const VF factor = hn::Set(d, 1.0f / float(term));
    for (int i = 0; i < Block<order>::size * sh::block; i += int(hn::Lanes(d)))
      hn::Store(hn::MulAdd(hn::Load(d, next.values + i), factor, hn::Load(d, g.values + i)), d, sum.values + i);
  }
  g = sum;
}

template <int order>
HWY_INLINE void Scale(const float* factors, Block<order>& f) {
  const Floats d;
  for (int i = 0; i < Block<order>::size * sh::block; i += int(hn::Lanes(d)))
    hn::Store(hn::Mul(hn::Load(d, factors + i % sh::block), hn::Load(d, f.values + i)), d, f.values + i);
}

/// exp(M) 1 = exp(M / s) ... exp(M / s) 1: with |M / s| <= 1 (`exact`) ten terms are exact to rounding; else s = 1.
template <int order>
HWY_INLINE void ByPowers(bool exact, int terms, const float* dc, Block<order>& f) {
  const Floats d;
  HWY_ALIGN float steps[sh::block], share[sh::block], e[sh::block];
  for (int k = 0; k < sh::block; k += int(hn::Lanes(d))) {
    Lanes part[order * order];
    f.Load(k, part);
    VF bound = hn::Zero(d);  // of |f(w)| for every w, and so of |M_f|
    for (int l = 1; l < order; ++l) {
      VF band = hn::Zero(d);
      for (int i = sh::index(l, -l); i <= sh::index(l, l); ++i) band = hn::MulAdd(part[i].v, part[i].v, band);
      bound = hn::MulAdd(hn::Sqrt(band), hn::Set(d, float(std::sqrt((2 * l + 1) / (4 * pi)))), bound);
    }
    const VF one = hn::Set(d, 1.0f), finite = hn::IfThenElseZero(hn::Lt(bound, hn::Set(d, 1e4f)), bound);
    const VF count = exact ? hn::Max(one, hn::Ceil(finite)) : one;
    hn::Store(count, d, steps + k);
    hn::Store(hn::Div(one, count), d, share + k);
    hn::Store(hn::Exp(d, hn::Div(hn::Load(d, dc + k), count)), d, e + k);
  }
  Scale<order>(share, f);
  Block<order> g = {};
  std::fill_n(g.values, sh::block, root_4pi);
  const float most = *std::max_element(steps, steps + sh::block);
  for (float step = 0.0f; step < most; ++step) {
    Block<order> next = g;
    Series<order>(f, exact ? 10 : terms, next);
    Scale<order>(e, next);
    TakeWithin<order>(step, steps, next, g);
  }
  f = g;
}

/// exp*(f), in place.
template <int order>
HWY_INLINE void Exponentiate(const Job& job, Block<order>& f) {
  HWY_ALIGN float dc[sh::block];
  for (int k = 0; k < sh::block; ++k) dc[k] = f.values[k] * (1.0f / root_4pi);
  std::fill_n(f.values, sh::block, 0.0f);
  const Exponential kind = job.method.kind;
  if (kind == Exponential::optimal_linear || kind == Exponential::hybrid)
    Linear<order>(job, kind == Exponential::hybrid, dc, f);
  else ByPowers<order>(kind == Exponential::exact, job.method.terms, dc, f);
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

/// Light . (visibility * lobe) at albedo 1, by channel, and what would arrive without an occluder.
template <int order>
HWY_INLINE void Reflect(const Job& job, const Lanes* reflected, const Lanes* lobe, Lanes* radiance, Lanes* unshadowed) {
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

/// Sum of the spheres' logarithms for as many receivers as a vector holds.
template <int order>
HWY_INLINE void Accumulate(const Job& job, const Group& group, std::span<const WeightedSphere> spheres, Lanes* f) {
  const Floats d;
  for (int i = 0; i < order * order; ++i) f[i] = hn::Zero(d);
  for (const WeightedSphere& sphere : spheres) {
    VF axis[3], cosine;
    const VF share = ShadowOf(sphere.sphere, group, job.replace && !sphere.bound, axis, &cosine);
    if (hn::AllFalse(d, hn::Gt(share, hn::Zero(d)))) continue;
    AddLogarithm<order>(*job.table, sphere, share, axis, cosine, f);
  }
}

template <int order>
HWY_NOINLINE void ShadeBlock(const Job& job, std::span<const int> which, std::span<const WeightedSphere> spheres,
                             vec3* out) {
  const std::size_t lanes = hn::Lanes(Floats());
  const auto part = [&](std::size_t k) { return which.subspan(k, std::min(lanes, which.size() - k)); };
  Block<order> visibility = {}, lobe = {}, reflected;
  Lanes f[order * order], g[order * order];
  for (std::size_t k = 0; k < which.size(); k += lanes) {
    const Group group = LoadGroup(*job.receivers, part(k));
    Accumulate<order>(job, group, spheres, f);
    visibility.Store(int(k), f);
    if (!job.by_normal.empty()) continue;
    CosineLobe<order>(job, group.normal, g);
    lobe.Store(int(k), g);
  }
  Exponentiate<order>(job, visibility);
  if (job.by_normal.empty()) sh::product_batch(order, visibility.values, lobe.values, sh::block, reflected.values);
  for (std::size_t k = 0; k < which.size(); k += lanes) {
    Lanes radiance[3], unshadowed[3];
    if (job.by_normal.empty()) {
      reflected.Load(int(k), f);
      lobe.Load(int(k), g);
      Reflect<order>(job, f, g, radiance, unshadowed);
    } else {
      visibility.Load(int(k), f);
      ReflectByTable<order>(job, part(k), f, radiance, unshadowed);
    }
    Write(job, part(k), radiance, unshadowed, out);
  }
}

void Shade(const Job& job, std::span<const int> which, std::span<const WeightedSphere> spheres, vec3* radiance) {
  sh::with_order<4, 6>(job.order, [&](auto n) HWY_ATTR {
    for (std::size_t k = 0; k < which.size(); k += sh::block)
      ShadeBlock<n>(job, which.subspan(k, std::min(std::size_t(sh::block), which.size() - k)), spheres, radiance);
  });
}

}  // namespace HWY_NAMESPACE
}  // namespace penumbra::sh_exponentiation
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace penumbra::sh_exponentiation {

HWY_EXPORT(Shade);

void shade(const Job& job, std::span<const int> which, std::span<const WeightedSphere> spheres, vec3* radiance) {
  HWY_DYNAMIC_DISPATCH(Shade)(job, which, spheres, radiance);
}

}  // namespace penumbra::sh_exponentiation
#endif  // HWY_ONCE
