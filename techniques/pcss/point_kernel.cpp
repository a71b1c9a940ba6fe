#include "techniques/pcss/kernel.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "techniques/pcss/point_kernel.cpp"
#include <hwy/foreach_target.h>  // IWYU pragma: keep

#include <hwy/contrib/math/math-inl.h>
#include "techniques/pcss/point-inl.h"

HWY_BEFORE_NAMESPACE();
namespace penumbra::pcss::simd {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

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
  const auto corner = [&](int k) {
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
    WithVectors(r, std::size_t(i), count, [&](const Vector3& position, const Vector3& normal) {
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

void Project(const LightView& view, const Receivers& r, float bias, Tile& tile) {
  const Floats d;
  const int lanes = int(hn::Lanes(d));
  const VF zero = hn::Zero(d), one = hn::Set(d, 1.0f);
  const auto set = [&](float v) { return hn::Set(d, v); };
  for (int row = 0; row < tile.rows; ++row)
    for (int column = 0; column < tile.columns; column += lanes) {
      const int count = tile.columns - column < lanes ? tile.columns - column : lanes;
      const std::size_t first = tile.first(row, r.width) + std::size_t(column);
      const int k = row * tile.columns + column;  // a vector that reaches into the next row is overwritten by it
      alignas(64) float on[Tile::padding] = {};
      for (int lane = 0; lane < count; ++lane) on[lane] = float(r.in_contact()[first + std::size_t(lane)]);
      WithVectors(r, first, count, [&](const Vector3& p, const Vector3& n) {
        const Vector3 to = Minus(p, All(view.centre));
        const VF z = Dot(All(view.normal), to);
        const VF a = Dot(All(view.across_u), to), b = Dot(All(view.across_v), to);
        const VF qx = view.perspective ? hn::Div(a, z) : hn::Sub(a, hn::Mul(set(view.shear.x), z));
        const VF qy = view.perspective ? hn::Div(b, z) : hn::Sub(b, hn::Mul(set(view.shear.y), z));
        const VF x = hn::Mul(hn::Sub(qx, set(view.low.x)), set(view.density));
        const VF y = hn::Mul(hn::Sub(qy, set(view.low.y)), set(view.density));
        // depth_bias()
        const VF cosine = hn::Div(hn::Neg(Dot(n, to)), hn::Sqrt(Dot(to, to)));
        const VF sine = hn::Sqrt(hn::Max(zero, hn::Sub(one, hn::Mul(cosine, cosine))));
        const VF tangent = hn::IfThenElse(hn::Gt(cosine, set(0.1f)), hn::Div(sine, cosine), set(10.0f));
        const VF size = view.perspective ? hn::Mul(set(view.metres), z) : set(view.metres);
        const VF raised = hn::Sub(z, hn::Mul(hn::Mul(set(bias), size), hn::Add(one, tangent)));
        const VF depth = hn::IfThenElse(hn::Gt(hn::Load(d, on), zero), raised, z);
        const MF valid = hn::Gt(hn::Add(hn::Add(hn::Abs(n.x), hn::Abs(n.y)), hn::Abs(n.z)), zero);
        const MF near = hn::And(hn::Lt(hn::Abs(x), set(1e6f)), hn::Lt(hn::Abs(y), set(1e6f)));
        const MF good = hn::And(hn::And(valid, near), hn::And(hn::Gt(z, zero), hn::Gt(depth, zero)));
        hn::StoreU(hn::IfThenElseZero(good, x), d, &tile.x[k]);
        hn::StoreU(hn::IfThenElseZero(good, y), d, &tile.y[k]);
        hn::StoreU(hn::IfThenElseZero(good, depth), d, &tile.depth[k]);
      });
    }
  tile.clear_padding();
}

// --- regions ---------------------------------------------------------------------------------------------------------

struct Squares {
  VI left, top, level;
};

HWY_INLINE VI SnappedLevel(VI w, Snapping::Size size) {
  // The exponent of w as a float; adding half a mantissa rounds it up where the second-highest bit of w is set.
  const VI bits = hn::BitCast(Ints(), hn::ConvertTo(Floats(), w));
  const VI carry = SetInt(size == Snapping::Size::nearest ? 0x400000 : 0x7fffff);
  return hn::Sub(hn::ShiftRight<23>(hn::Add(bits, carry)), SetInt(127));
}

HWY_INLINE void SnappedRange(VF centre, VF width, int edge, bool inclusive, VI& first, VI& last) {
  const VF half = hn::Mul(hn::Set(Floats(), 0.5f), width);
  first = FloorInt(hn::Sub(centre, half));
  last = hn::Sub(CeilInt(hn::Add(centre, half)), SetInt(inclusive ? 0 : 1));
  last = hn::Max(first, last);
  first = hn::Max(first, SetInt(0));
  last = hn::Min(last, SetInt(edge - 1));
}

HWY_INLINE VI SnappedStart(VI first, VF centre, VI square, int edge, bool centred) {
  const Floats d;
  VI start = first;
  if (centred) {
    const VF half = hn::Mul(hn::Set(d, 0.5f), hn::ConvertTo(d, square));
    start = FloorInt(hn::Add(hn::Sub(centre, half), hn::Set(d, 0.5f)));
  }
  return hn::Min(hn::Max(start, SetInt(0)), hn::Sub(SetInt(edge), square));
}

/// snap().
HWY_INLINE Squares Snap(VF x, VF y, VF width, int edge, int largest, const Snapping& how) {
  VI left, right, top, bottom;
  SnappedRange(x, width, edge, how.inclusive, left, right);
  SnappedRange(y, width, edge, how.inclusive, top, bottom);
  const VI one = SetInt(1);
  const VI w = hn::Sub(right, left), h = hn::Sub(bottom, top);
  const auto none = hn::Lt(hn::Min(w, h), SetInt(0));
  const VI across = SnappedLevel(hn::Max(one, hn::Add(w, one)), how.size);
  const VI down = SnappedLevel(hn::Max(one, hn::Add(h, one)), how.size);
  VI level = hn::IfThenElse(hn::Eq(across, down), across, hn::Add(hn::Min(across, down), one));
  level = hn::Min(level, SetInt(largest));
  const VI square = hn::Shl(one, level);
  return {SnappedStart(left, x, square, edge, how.centred), SnappedStart(top, y, square, edge, how.centred),
          hn::IfThenElse(none, SetInt(-1), level)};
}

/// MultiScaleMap::index.
HWY_INLINE VI Index(const MultiScaleMap& map, const Squares& s) {
  const VI edge = SetInt(map.edge());
  const VI level = hn::Max(s.level, SetInt(0));
  const VI stride =
      map.layout() == LevelLayout::full ? edge : hn::Add(hn::Sub(edge, hn::Shl(SetInt(1), level)), SetInt(1));
  return hn::Add(hn::Add(hn::Mul(level, SetInt(map.edge() * map.edge())), hn::Mul(s.top, stride)), s.left);
}

HWY_INLINE void StoreSquares(const Squares& s, Square* out) {
  static_assert(sizeof(Square) == 3 * sizeof(int));
  hn::StoreInterleaved3(s.left, s.top, s.level, Ints(), &out->left);
}

/// Own number where the mask holds, -1 elsewhere.
HWY_INLINE void StoreRepresentatives(MF open, int k, int* out) {
  const Ints di;
  const VI own = hn::Iota(di, k);
  hn::StoreU(hn::IfThenElse(hn::RebindMask(di, open), own, SetInt(-1)), di, out);
}

void SearchRegions(const LightView& view, const MultiScaleMap& levels, const SoftOptions& options, Tile& tile) {
  const Floats d;
  const Ints di;
  const int n = view.resolution;
  const VF near = hn::Set(d, view.near);
  for (int k = 0; k < tile.size(); k += int(hn::Lanes(d))) {
    const VF x = hn::LoadU(d, &tile.x[k]), y = hn::LoadU(d, &tile.y[k]), depth = hn::LoadU(d, &tile.depth[k]);
    MF open = hn::Gt(depth, near);
    const VF safe = hn::Max(depth, near);
    VF width = Region(view, near, safe);
    // misses_map()
    const VF half = hn::Mul(hn::Set(d, 0.5f), width), zero = hn::Zero(d), end = hn::Set(d, float(n));
    const MF reaches = hn::And(hn::Ge(hn::Add(x, half), zero), hn::Ge(hn::Add(y, half), zero));
    const MF begins = hn::And(hn::Lt(hn::Sub(x, half), end), hn::Lt(hn::Sub(y, half), end));
    open = hn::And(open, hn::And(reaches, begins));
    Squares squares = {SetInt(0), SetInt(0), SetInt(-1)};
    if (options.refine) {
      MF searching = open;
      for (int i = 0; i < most_refinements && !hn::AllFalse(d, searching); ++i) {
        squares = Snap(x, y, width, n, levels.largest(), options.snapping);
        const MF there = hn::RebindMask(d, hn::Gt(squares.level, SetInt(-1)));
        const MF look = hn::And(searching, there);
        const VI index = hn::IfThenElseZero(hn::RebindMask(di, look), Index(levels, squares));
        const VF low = hn::GatherIndex(d, levels.bounds(), hn::Add(index, index));
        const MF hit = hn::And(look, hn::Lt(low, depth));
        open = hn::And(open, hn::Or(hit, hn::Not(searching)));
        const VF next = hn::Min(width, Region(view, low, safe));
        searching = hn::And(hit, hn::Ge(hn::Sub(width, next), hn::Set(d, 1.0f)));
        width = hn::IfThenElse(hit, next, width);
      }
    }
    if (options.multi_scale) {
      squares = Snap(x, y, width, n, levels.largest(), options.snapping);
      open = hn::And(open, hn::RebindMask(d, hn::Gt(squares.level, SetInt(-1))));
    }
    hn::StoreU(width, d, &tile.width[k]);
    StoreSquares(squares, &tile.square[k]);
    StoreRepresentatives(open, k, &tile.representative[k]);
  }
}

void FilterRegions(const LightView& view, const MultiScaleMap& levels, const SoftOptions& options, Tile& tile) {
  const Floats d;
  const Ints di;
  const int n = view.resolution;
  const VF zero = hn::Zero(d), one = hn::Set(d, 1.0f);
  for (int k = 0; k < tile.size(); k += int(hn::Lanes(d))) {
    const VF x = hn::LoadU(d, &tile.x[k]), y = hn::LoadU(d, &tile.y[k]), depth = hn::LoadU(d, &tile.depth[k]);
    const VI representative = hn::LoadU(di, &tile.representative[k]);
    const auto linked = hn::Gt(representative, SetInt(-1));
    const VF blocker = hn::GatherIndex(d, tile.blocker.data(), hn::IfThenElseZero(linked, representative));
    MF open = hn::And(hn::RebindMask(d, linked), hn::And(hn::Gt(blocker, zero), hn::Lt(blocker, depth)));
    const VF safe = hn::IfThenElse(open, blocker, one), safe_depth = hn::IfThenElse(open, depth, one);
    const VF width = Region(view, safe, safe_depth, options.filter_scale);
    hn::StoreU(hn::IfThenElse(open, width, hn::LoadU(d, &tile.width[k])), d, &tile.width[k]);
    if (options.multi_scale) {
      const Squares squares = Snap(x, y, width, n, levels.largest(), options.snapping);
      open = hn::And(open, hn::RebindMask(d, hn::Gt(squares.level, SetInt(-1))));
      StoreSquares(squares, &tile.square[k]);
    }
    hn::StoreU(one, d, &tile.visibility[k]);
    StoreRepresentatives(open, k, &tile.representative[k]);
  }
}

const char* Target() {
  return hwy::TargetName(HWY_TARGET);
}

}  // namespace HWY_NAMESPACE
}  // namespace penumbra::pcss::simd
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace penumbra::pcss::simd {

HWY_EXPORT(FindUnshadowed);
HWY_EXPORT(Project);
HWY_EXPORT(SearchRegions);
HWY_EXPORT(FilterRegions);
HWY_EXPORT(Target);

void find_unshadowed(const LampOutline& lamp, const Receivers& receivers, int begin, int end, float* factor) {
  HWY_DYNAMIC_DISPATCH(FindUnshadowed)(lamp, receivers, begin, end, factor);
}
void project(const LightView& view, const Receivers& receivers, float bias, Tile& tile) {
  HWY_DYNAMIC_DISPATCH(Project)(view, receivers, bias, tile);
}
void search_regions(const LightView& view, const MultiScaleMap& levels, const SoftOptions& options, Tile& tile) {
  HWY_DYNAMIC_DISPATCH(SearchRegions)(view, levels, options, tile);
}
void filter_regions(const LightView& view, const MultiScaleMap& levels, const SoftOptions& options, Tile& tile) {
  HWY_DYNAMIC_DISPATCH(FilterRegions)(view, levels, options, tile);
}
std::string target() {
  return HWY_DYNAMIC_DISPATCH(Target)();
}

}  // namespace penumbra::pcss::simd
#endif  // HWY_ONCE
