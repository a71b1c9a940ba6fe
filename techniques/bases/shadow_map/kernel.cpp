#include "techniques/bases/shadow_map/kernel.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "techniques/bases/shadow_map/kernel.cpp"
#include <hwy/foreach_target.h>  // IWYU pragma: keep

#include <hwy/contrib/math/math-inl.h>
#include "techniques/bases/shadow_map/point-inl.h"

HWY_BEFORE_NAMESPACE();
namespace penumbra::shadow_map::simd {
namespace HWY_NAMESPACE {

struct Vector3 {
  VF x, y, z;
};
HWY_INLINE VF Dot(const Vector3& a, const Vector3& b) {
  return hn::Add(hn::Add(hn::Mul(a.x, b.x), hn::Mul(a.y, b.y)), hn::Mul(a.z, b.z));
}
HWY_INLINE Vector3 Minus(const Vector3& a, const Vector3& b) {
  return {hn::Sub(a.x, b.x), hn::Sub(a.y, b.y), hn::Sub(a.z, b.z)};
}
HWY_INLINE Vector3 Times(const Vector3& a, VF by) {
  return {hn::Mul(a.x, by), hn::Mul(a.y, by), hn::Mul(a.z, by)};
}
HWY_INLINE Vector3 Cross(const Vector3& a, const Vector3& b) {
  return {hn::Sub(hn::Mul(a.y, b.z), hn::Mul(b.y, a.z)), hn::Sub(hn::Mul(a.z, b.x), hn::Mul(b.z, a.x)),
          hn::Sub(hn::Mul(a.x, b.y), hn::Mul(b.x, a.y))};
}
HWY_INLINE Vector3 All(vec3 v) {
  const Floats d;
  return {hn::Set(d, v.x), hn::Set(d, v.y), hn::Set(d, v.z)};
}
HWY_INLINE Vector3 LoadVectors(const vec3* from) {
  static_assert(sizeof(vec3) == 3 * sizeof(float));
  Vector3 v;
  hn::LoadInterleaved3(Floats(), &from->x, v.x, v.y, v.z);
  return v;
}

/// Positions and normals of up to one vector of receivers; lanes past the last repeat it.
struct Loaded {
  vec3 position[Tile::padding], normal[Tile::padding];
  HWY_INLINE Loaded(const Receivers& r, std::size_t first, int count) {
    const int lanes = int(hn::Lanes(Floats()));
    for (int k = 0; k < lanes; ++k) {
      const std::size_t i = first + std::size_t(k < count ? k : count - 1);
      position[k] = r.position[i], normal[k] = r.normal[i];
    }
  }
};
template <class Use>
HWY_INLINE void WithVectors(const Receivers& r, std::size_t first, int count, const Use& use) {
  if (count >= int(hn::Lanes(Floats()))) return use(LoadVectors(&r.position[first]), LoadVectors(&r.normal[first]));
  const Loaded part(r, first, count);
  use(LoadVectors(part.position), LoadVectors(part.normal));
}

// --- unshadowed light ------------------------------------------------------------------------------------------------

/// Form factor of a parallelogram that lies above the horizon; `clipped`: lanes where a corner does not.
HWY_INLINE VF PolygonFactor(const LampOutline& lamp, const Vector3& position, const Vector3& normal, MF& clipped) {
  const Floats d;
  const VF zero = hn::Zero(d), one = hn::Set(d, 1.0f), two = hn::Set(d, 2.0f);
  clipped = hn::Lt(one, zero);
  const auto corner = [&](int k) HWY_ATTR {
    Vector3 to = Minus(All(lamp.corner[k]), position);
    clipped = hn::Or(clipped, hn::Not(hn::Gt(Dot(normal, to), zero)));
    const VF inverse = hn::Div(one, hn::Sqrt(Dot(to, to)));
    return Vector3{hn::Mul(to.x, inverse), hn::Mul(to.y, inverse), hn::Mul(to.z, inverse)};
  };
  const Vector3 first = corner(0);
  Vector3 last = first, sum = {zero, zero, zero};
  for (int k = 1; k <= lamp.count; ++k) {
    const Vector3 next = k < lamp.count ? corner(k) : first;
    const Vector3 cross = Cross(last, next);
    const VF sine = hn::Sqrt(Dot(cross, cross)), cosine = Dot(last, next);
    // theta / sin(theta), with tan(theta / 2) = sin / (1 + cos)
    const VF angle = hn::Mul(two, hn::Atan(d, hn::Div(sine, hn::Add(one, cosine))));
    const VF scale = hn::IfThenElse(hn::Gt(sine, zero), hn::Div(angle, sine), one);
    sum = {hn::Add(sum.x, hn::Mul(cross.x, scale)), hn::Add(sum.y, hn::Mul(cross.y, scale)),
           hn::Add(sum.z, hn::Mul(cross.z, scale))};
    last = next;
  }
  return hn::Max(zero, hn::Mul(Dot(normal, sum), hn::Set(d, float(0.5 / pi))));
}

/// disc_factor() of a disc that lies above the horizon; `cut`: lanes where part of it does not.
HWY_INLINE VF DiscFactor(const LampOutline& lamp, const Vector3& position, const Vector3& normal, MF& cut) {
  const Floats d;
  const VF zero = hn::Zero(d), two = hn::Set(d, 2.0f), r = hn::Set(d, lamp.radius), r2 = hn::Mul(r, r);
  const Vector3 to = Minus(All(lamp.centre), position), z = All(-lamp.normal);
  const VF h = Dot(z, to), upright = Dot(z, normal), h2 = hn::Mul(h, h);
  const Vector3 lean = Minus(normal, Times(z, upright)), beside = Minus(to, Times(z, h));
  cut = hn::Not(hn::Ge(Dot(normal, to), hn::Mul(r, hn::Sqrt(Dot(lean, lean)))));
  const VF d2 = Dot(beside, beside), aside = hn::Sqrt(d2), near = hn::Sub(aside, r), far = hn::Add(aside, r);
  const VF s = hn::Mul(hn::Sqrt(hn::Add(hn::Mul(far, far), h2)), hn::Sqrt(hn::Add(hn::Mul(near, near), h2)));
  const VF a = hn::Sub(hn::Add(d2, h2), r2), b = hn::Add(hn::Add(d2, h2), r2);
  const VF rh = hn::Mul(r, h), k = hn::Div(hn::Mul(two, rh), s);
  const VF outside = hn::Mul(k, hn::Div(rh, hn::Add(s, a))), inside = hn::Div(hn::Sub(s, a), hn::Mul(two, s));
  const VF facing = hn::IfThenElse(hn::Gt(a, zero), outside, inside);
  const VF across = hn::Mul(k, hn::Div(r, hn::Add(b, s)));
  return hn::Max(zero, hn::Add(hn::Mul(upright, facing), hn::Mul(Dot(normal, beside), across)));
}

void FindUnshadowed(const LampOutline& lamp, const Receivers& r, int begin, int end, float* factor) {
  const Floats d;
  const int lanes = int(hn::Lanes(d));
  alignas(64) float out[Tile::padding];
  for (int i = begin; i < end; i += lanes) {
    const int count = end - i < lanes ? end - i : lanes;
    WithVectors(r, std::size_t(i), count, [&](const Vector3& position, const Vector3& normal) HWY_ATTR {
      MF clipped;
      const VF value = lamp.radius > 0.0f ? DiscFactor(lamp, position, normal, clipped)
                                          : PolygonFactor(lamp, position, normal, clipped);
      const MF front = hn::Gt(Dot(All(lamp.normal), Minus(position, All(lamp.centre))), hn::Zero(d));
      hn::Store(hn::IfThenElseZero(front, value), d, out);
      const MF redo = hn::And(front, clipped);
      if (!hn::AllFalse(d, redo)) {
        alignas(64) float flag[Tile::padding];
        hn::Store(hn::IfThenElseZero(redo, hn::Set(d, 1.0f)), d, flag);
        for (int k = 0; k < count; ++k)
          if (flag[k] != 0.0f) out[k] = r.valid(i + k) ? form_factor(lamp, r.position[i + k], r.normal[i + k]) : 0.0f;
      }
    });
    for (int k = 0; k < count; ++k) factor[i + k] = out[k];
  }
}

// --- projection ------------------------------------------------------------------------------------------------------

void Project(const LightView& view, const Receivers& r, Bias bias, Tile& tile) {
  const Floats d;
  const int lanes = int(hn::Lanes(d));
  const VF zero = hn::Zero(d), one = hn::Set(d, 1.0f);
  const auto set = [&](float v) HWY_ATTR { return hn::Set(d, v); };
  for (int row = 0; row < tile.rows; ++row)
    for (int column = 0; column < tile.columns; column += lanes) {
      const int count = tile.columns - column < lanes ? tile.columns - column : lanes;
      const std::size_t first = tile.first(row, r.width) + std::size_t(column);
      const int k = row * tile.columns + column;  // a vector that reaches into the next row is overwritten by it
      alignas(64) float on[Tile::padding] = {};
      for (int lane = 0; lane < count; ++lane) on[lane] = float(r.in_contact()[first + std::size_t(lane)]);
      WithVectors(r, first, count, [&](const Vector3& p, const Vector3& n) HWY_ATTR {
        const Vector3 to = Minus(p, All(view.centre));
        const VF z = Dot(All(view.normal), to);
        const VF a = Dot(All(view.across_u), to), b = Dot(All(view.across_v), to);
        const VF qx = view.perspective ? hn::Div(a, z) : hn::Sub(a, hn::Mul(set(view.shear.x), z));
        const VF qy = view.perspective ? hn::Div(b, z) : hn::Sub(b, hn::Mul(set(view.shear.y), z));
        const VF x = hn::Mul(hn::Sub(qx, set(view.low.x)), set(view.density));
        const VF y = hn::Mul(hn::Sub(qy, set(view.low.y)), set(view.density));
        // slope_to_light(), depth_bias(), region_rise()
        const VF cosine = hn::Div(hn::Neg(Dot(n, to)), hn::Sqrt(Dot(to, to)));
        const VF sine = hn::Sqrt(hn::Max(zero, hn::Sub(one, hn::Mul(cosine, cosine))));
        const VF tangent = hn::IfThenElse(hn::Gt(cosine, set(0.1f)), hn::Div(sine, cosine), set(10.0f));
        const VF size = view.perspective ? hn::Mul(set(view.metres), z) : set(view.metres);
        const VF raised = hn::Sub(z, hn::Mul(hn::Mul(set(bias.texels), size), hn::Add(one, tangent)));
        const MF touches = hn::Gt(hn::Load(d, on), zero);
        const VF depth = hn::IfThenElse(touches, raised, z);
        const VF slant = hn::Min(tangent, set(steepest_rise));
        const VF rise = hn::IfThenElseZero(touches, hn::Mul(hn::Mul(set(0.5f * bias.region), size), slant));
        const MF valid = hn::Gt(hn::Add(hn::Add(hn::Abs(n.x), hn::Abs(n.y)), hn::Abs(n.z)), zero);
        const MF near = hn::And(hn::Lt(hn::Abs(x), set(1e6f)), hn::Lt(hn::Abs(y), set(1e6f)));
        const MF good = hn::And(hn::And(valid, near), hn::And(hn::Gt(z, zero), hn::Gt(depth, zero)));
        hn::StoreU(hn::IfThenElseZero(good, x), d, &tile.x[k]);
        hn::StoreU(hn::IfThenElseZero(good, y), d, &tile.y[k]);
        hn::StoreU(hn::IfThenElseZero(good, depth), d, &tile.depth[k]);
        hn::StoreU(hn::IfThenElseZero(good, rise), d, &tile.rise[k]);
      });
    }
  tile.clear_padding();
}

}  // namespace HWY_NAMESPACE
}  // namespace penumbra::shadow_map::simd
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace penumbra::shadow_map::simd {

HWY_EXPORT(FindUnshadowed);
HWY_EXPORT(Project);

void find_unshadowed(const LampOutline& lamp, const Receivers& receivers, int begin, int end, float* factor) {
  HWY_DYNAMIC_DISPATCH(FindUnshadowed)(lamp, receivers, begin, end, factor);
}
void project(const LightView& view, const Receivers& receivers, Bias bias, Tile& tile) {
  HWY_DYNAMIC_DISPATCH(Project)(view, receivers, bias, tile);
}
}  // namespace penumbra::shadow_map::simd
#endif  // HWY_ONCE
