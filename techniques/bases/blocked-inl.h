// Which texels spheres block, vectorised over spheres and texels. Included once per instruction set by the kernels of
// techniques (Highway's -inl.h pattern); bits are identical to merge_spheres() and rasterise_spheres().
#if defined(PENUMBRA_BLOCKED_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef PENUMBRA_BLOCKED_INL_H_
#undef PENUMBRA_BLOCKED_INL_H_
#else
#define PENUMBRA_BLOCKED_INL_H_
#endif

#include <hwy/cache_control.h>
#include <hwy/highway.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

#include "scenes/cube_map.h"
#include "techniques/bases/blocked.h"

HWY_BEFORE_NAMESPACE();
namespace penumbra {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Floats = hn::ScalableTag<float>;
using Words = hn::ScalableTag<std::uint32_t>;
using Ints = hn::ScalableTag<std::int32_t>;
using VF = hn::Vec<Floats>;

constexpr int most_lines = 48;  // n = 64

/// Blocked texels of one receiver, and which lines have any.
struct Blocked {
  HWY_ALIGN std::uint32_t words[most_lines * words_per_line];
  std::uint64_t touched;  ///< lines not in here are open and their words are not written
};

/// Zeroes a line when it is first touched.
HWY_INLINE std::uint32_t* Touch(Blocked& blocked, int line) {
  std::uint32_t* words = blocked.words + line * words_per_line;
  if (!(blocked.touched >> line & 1u)) {
    blocked.touched |= std::uint64_t(1) << line;
    const Words d;
    for (int w = 0; w < words_per_line; w += int(hn::Lanes(d))) hn::Store(hn::Zero(d), d, words + w);
  }
  return words;
}

HWY_INLINE void BlockEverything(Blocked& blocked, int lines) {
  const Words d;
  blocked.touched = ~std::uint64_t(0) >> (64 - lines);
  for (int w = 0; w < lines * words_per_line; w += int(hn::Lanes(d))) hn::Store(hn::Set(d, ~0u), d, blocked.words + w);
}

// --- spheres through the table ---------------------------------------------------------------------------------------

constexpr int chunk = 64;  // look-ups computed ahead of the merge, so that prefetches have time to arrive

/// Table entries of spheres [first, first + chunk): SphereTable::entry for many spheres at once, operation by
/// operation.
HWY_INLINE void FindEntries(const BlockedJob& job, int first, int count, vec3 x, std::int32_t* entries) {
  const Floats d;
  const Ints di;
  const SphereLanes& s = *job.spheres;
  const int n = job.table->n();
  const VF zero = hn::Zero(d), one = hn::Set(d, 1.0f), half_n = hn::Set(d, 0.5f * float(n));
  for (int i = 0; i < count; i += int(hn::Lanes(d))) {
    const int k = first + i;
    const VF tx = hn::Sub(hn::LoadU(d, &s.x[k]), hn::Set(d, x.x));
    const VF ty = hn::Sub(hn::LoadU(d, &s.y[k]), hn::Set(d, x.y));
    const VF tz = hn::Sub(hn::LoadU(d, &s.z[k]), hn::Set(d, x.z));
    const VF radius = hn::LoadU(d, &s.radius[k]);
    const VF d2 = hn::Add(hn::Add(hn::Mul(tx, tx), hn::Mul(ty, ty)), hn::Mul(tz, tz));
    const VF r2 = hn::Mul(radius, radius);
    const VF ratio2 = hn::Div(r2, d2);

    auto bin = hn::Zero(di);
    for (int b = 0; b + 1 < SphereTable::bins; ++b) {
      const auto above = hn::RebindMask(di, hn::Ge(ratio2, hn::Set(d, job.table->thresholds()[b])));
      bin = hn::Sub(bin, hn::VecFromMask(di, above));  // a mask is -1
    }

    // cube_face() and cube_coordinate()
    const VF ax = hn::Abs(tx), ay = hn::Abs(ty), az = hn::Abs(tz);
    const auto on_x = hn::And(hn::Ge(ax, ay), hn::Ge(ax, az));
    const auto on_y = hn::Ge(ay, az);
    const VF major = hn::IfThenElse(on_x, tx, hn::IfThenElse(on_y, ty, tz));
    const auto positive = hn::Gt(major, zero);
    const VF inverse = hn::Div(one, hn::Abs(major));
    const VF s_x = hn::IfThenElse(positive, hn::Neg(tz), tz);
    const VF s_z = hn::IfThenElse(positive, tx, hn::Neg(tx));
    const VF t_y = hn::IfThenElse(positive, tz, hn::Neg(tz));
    const VF u = hn::Mul(hn::IfThenElse(on_x, s_x, hn::IfThenElse(on_y, tx, s_z)), inverse);
    const VF v = hn::Mul(hn::IfThenElse(hn::AndNot(on_x, on_y), t_y, hn::Neg(ty)), inverse);
    const auto to_index = [&](VF c) HWY_ATTR {
      const auto at = hn::ConvertTo(di, hn::Mul(hn::Add(c, one), half_n));
      return hn::Min(hn::Max(at, hn::Zero(di)), hn::Set(di, n - 1));
    };
    const auto axis = hn::IfThenElse(hn::RebindMask(di, on_x), hn::Zero(di),
                                     hn::IfThenElse(hn::RebindMask(di, on_y), hn::Set(di, 2), hn::Set(di, 4)));
    const auto face = hn::Add(axis, hn::IfThenElse(hn::RebindMask(di, positive), hn::Zero(di), hn::Set(di, 1)));
    const auto texel =
        hn::Add(hn::Mul(hn::Add(hn::Mul(face, hn::Set(di, n)), to_index(v)), hn::Set(di, n)), to_index(u));
    auto entry = hn::Add(hn::Mul(texel, hn::Set(di, SphereTable::bins)), bin);
    entry = hn::IfThenElse(hn::RebindMask(di, hn::Lt(r2, d2)), entry, hn::Set(di, -1));
    entry = hn::IfThenElse(hn::RebindMask(di, hn::Gt(r2, zero)), entry, hn::Set(di, -2));
    hn::StoreU(entry, di, entries + i);
  }
}

HWY_INLINE void MergeTable(const BlockedJob& job, vec3 x, std::uint64_t active, int lines, Blocked& blocked) {
  const Words d;
  const std::uint32_t* data = job.table->data();
  const std::uint16_t* masks = job.table->masks();
  const int words = job.table->words();
  HWY_ALIGN std::int32_t entries[chunk];
  HWY_ALIGN std::uint32_t wanted[chunk];
  for (int first = 0; first < job.spheres->padded(); first += chunk) {
    const int count = std::min(chunk, job.spheres->padded() - first);
    FindEntries(job, first, count, x, entries);
    for (int i = 0; i < count; ++i) {
      if (entries[i] == -1) return BlockEverything(blocked, lines);
      wanted[i] = entries[i] < 0 ? 0u : std::uint32_t(masks[entries[i]] & active);
      for (std::uint32_t left = wanted[i]; left; left &= left - 1)
        hwy::Prefetch(data + std::size_t(entries[i]) * words + std::countr_zero(left) * words_per_line);
    }
    for (int i = 0; i < count; ++i)
      for (std::uint32_t left = wanted[i]; left; left &= left - 1) {
        const int line = std::countr_zero(left);
        const std::uint32_t* from = data + std::size_t(entries[i]) * words + line * words_per_line;
        std::uint32_t* to = Touch(blocked, line);
        for (int w = 0; w < words_per_line; w += int(hn::Lanes(d)))
          hn::Store(hn::Or(hn::Load(d, to + w), hn::LoadU(d, from + w)), d, to + w);
      }
  }
}

// --- spheres exactly -------------------------------------------------------------------------------------------------

/// Rows [low, high) of a face that a cap can reach: the tangent planes through the face's s axis. With the cap's axis
/// (b, w) along t and the face, t is within where (b - t w)^2 <= sin^2 (1 + t^2). One row of slack covers rounding.
HWY_INLINE void RowRange(float b, float w, float sine, int n, int& low, int& high) {
  low = 0, high = n;
  const float denominator = w * w - sine * sine;
  if (w <= 0.0f || denominator <= 1e-4f) return;
  const float root = sine * std::sqrt(std::max(0.0f, b * b + denominator));
  const float half_n = 0.5f * float(n);
  low = std::max(0, int(std::floor(((b * w - root) / denominator + 1.0f) * half_n - 1.5f)));
  high = std::min(n, int(std::ceil(((b * w + root) / denominator + 1.0f) * half_n + 1.5f)));
}

/// Do the cap and a line's bounding cone (angular radii theta and rho) share a direction? They do when the angle
/// between the axes is at most theta + rho; always when that exceeds pi. Errs on the side of yes.
HWY_INLINE bool ConesMeet(const Cap& cap, float sine, vec3 axis, float line_cosine, float line_sine) {
  const float sine_of_sum = sine * line_cosine + cap.cosine * line_sine;
  const float cosine_of_sum = cap.cosine * line_cosine - sine * line_sine;
  return sine_of_sum <= 0.0f || dot_in_order(axis, cap.axis) >= cosine_of_sum - 1e-5f;
}

/// Sets the bits of texels [begin, end), whole words of one line, that the cap covers.
HWY_INLINE void RasteriseLine(const LineCones& cones, const Cap& cap, int line, int begin, int end, Blocked& blocked) {
  const Floats d;
  const int lanes = int(hn::Lanes(d));
  const VF vx = hn::Set(d, cap.axis.x), vy = hn::Set(d, cap.axis.y), vz = hn::Set(d, cap.axis.z);
  const VF cosine = hn::Set(d, cap.cosine);
  std::uint32_t* words = Touch(blocked, line) - line * words_per_line;
  for (int t = begin; t < end; t += 32) {
    std::uint32_t bits = 0;
    for (int k = 0; k < 32; k += lanes) {
      const VF dot = hn::Add(hn::Add(hn::Mul(hn::LoadU(d, &cones.direction[0][t + k]), vx),
                                     hn::Mul(hn::LoadU(d, &cones.direction[1][t + k]), vy)),
                             hn::Mul(hn::LoadU(d, &cones.direction[2][t + k]), vz));
      std::uint8_t packed[8] = {};
      hn::StoreMaskBits(d, hn::Ge(dot, cosine), packed);
      std::uint32_t part;
      std::memcpy(&part, packed, sizeof part);
      bits |= (lanes == 32 ? part : part & ((1u << (lanes & 31)) - 1u)) << k;
    }
    words[t / 32] |= bits;
  }
}

HWY_INLINE void RasteriseSpheres(const BlockedJob& job, vec3 x, std::uint64_t active, int lines, Blocked& blocked) {
  const LineCones& cones = *job.cones;
  for (int i = 0; i < job.spheres->padded(); ++i) {
    const SphereLanes& s = *job.spheres;
    const Cap cap = make_cap({s.x[i], s.y[i], s.z[i]}, s.radius[i], x);
    if (cap.cosine > 1.0f) continue;
    if (cap.cosine < -1.0f) return BlockEverything(blocked, lines);
    const float sine = std::sqrt(1.0f - cap.cosine * cap.cosine) + 1e-5f;
    for (std::uint64_t left = active; left; left &= left - 1) {
      const int line = std::countr_zero(left);
      if (!ConesMeet(cap, sine, cones.axis[line], cones.cosine[line], cones.sine[line])) continue;
      int begin = line * texels_per_line, end = begin + texels_per_line;
      if (cones.n >= 32) {  // a line is within one face
        const int face = begin / (cones.n * cones.n), first = face * cones.n * cones.n;
        const vec3 major = cube_direction(face, 0.0f, 0.0f), down = cube_direction(face, 0.0f, 1.0f) - major;
        int low, high;
        RowRange(glm::dot(cap.axis, down), glm::dot(cap.axis, major), sine, cones.n, low, high);
        begin = std::max(begin, first + low * cones.n);
        end = std::min(end, first + high * cones.n);
      }
      if (begin < end) RasteriseLine(cones, cap, line, begin, end, blocked);
    }
  }
}

/// Texels of the lines in `active` that the occluder blocks for receiver i. `traced` is scratch for rays.
HWY_INLINE void FindBlocked(const BlockedJob& job, int i, std::uint64_t active, BitCube& traced, Blocked& blocked) {
  const Receivers& r = *job.receivers;
  const int lines = lines_of(job.cones->n);
  blocked.touched = 0;
  if (job.rays) {
    traced.fill(false);
    trace_texels(*job.rays, r.ray_origin(i), r.normal[i], *job.directions, true, traced);
    std::copy(traced.words.begin(), traced.words.end(), blocked.words);
    blocked.touched = ~std::uint64_t(0) >> (64 - lines);
  } else if (!r.on_occluder[i]) {  // an object's own spheres swallow its surface
    if (job.table) MergeTable(job, r.position[i], active, lines, blocked);
    else RasteriseSpheres(job, r.position[i], active, lines, blocked);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace penumbra
HWY_AFTER_NAMESPACE();

#endif  // include guard that toggles per target
