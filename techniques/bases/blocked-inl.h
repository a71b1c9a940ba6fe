// Which texels block a receiver's light, vectorised over spheres, rows and texels. Included once per instruction set by
// the kernels of techniques (Highway's -inl.h pattern); bits are identical to merge_spheres() and rasterise_spheres().
#if defined(PENUMBRA_BLOCKED_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef PENUMBRA_BLOCKED_INL_H_
#undef PENUMBRA_BLOCKED_INL_H_
#else
#define PENUMBRA_BLOCKED_INL_H_
#endif

#include <hwy/cache_control.h>

#include "techniques/bases/cap_rows-inl.h"

HWY_BEFORE_NAMESPACE();
namespace penumbra {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// --- spheres through the table ---------------------------------------------------------------------------------------

constexpr int chunk = 64;  // look-ups computed ahead of the merge, so that prefetches have time to arrive

/// Table entries of spheres [first, first + chunk): SphereTable::entry for many spheres at once, operation by
/// operation.
HWY_INLINE void FindEntries(const BlockedJob& job, int first, int count, vec3 x, std::int32_t* entries) {
  const Floats d;
  const Ints di;
  const SphereLanes& s = *job.spheres;
  const SphereTable::Bins& bins = job.table->bins();
  const int n = job.table->shape().edge;
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
    if (bins.per_ratio > 0.0f) {
      bin = hn::ConvertTo(
          di, hn::Min(hn::Mul(hn::Sqrt(ratio2), hn::Set(d, bins.per_ratio)), hn::Set(d, float(bins.count))));
    } else {
      for (int b = 0; b + 1 < SphereTable::published_bins; ++b) {  // the last is above every ratio
        const auto above = hn::RebindMask(di, hn::Ge(ratio2, hn::Set(d, bins.upper[b])));
        bin = hn::Sub(bin, hn::VecFromMask(di, above));  // a mask is -1
      }
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
    const auto beyond = hn::Gt(bin, hn::Set(di, bins.count - 1));
    auto entry = hn::Add(hn::Mul(texel, hn::Set(di, bins.count)), bin);
    entry = hn::IfThenElse(beyond, hn::Set(di, beyond_table), entry);
    entry = hn::IfThenElse(hn::RebindMask(di, hn::Lt(r2, d2)), entry, hn::Set(di, blocks_everything));
    entry = hn::IfThenElse(hn::RebindMask(di, hn::Gt(r2, zero)), entry, hn::Set(di, blocks_nothing));
    hn::StoreU(entry, di, entries + i);
  }
}

/// Spheres of a chunk that the table does not go up to.
struct Beyond {
  HWY_ALIGN float x[chunk] = {}, y[chunk] = {}, z[chunk] = {}, radius[chunk] = {};
  int count = 0;
  HWY_INLINE void add(const SphereLanes& s, int k) {
    x[count] = s.x[k], y[count] = s.y[k], z[count] = s.z[k], radius[count] = s.radius[k];
    ++count;
  }
  HWY_INLINE void rasterise(const LineCones& cones, vec3 at, std::uint64_t active, RowQueue& queue, Blocked& blocked) {
    if (count == 0) return;
    while (count % 16) radius[count++] = 0.0f;
    RasteriseSpheres(cones, x, y, z, radius, count, at, active, queue, blocked);
    count = 0;
  }
};

/// The search for the texels that block a receiver's light, with what it needs to hand.
class Search {
 public:
  HWY_INLINE explicit Search(const BlockedJob& job)
      : job_(job), traced_(job.rays ? job.cones->n : 0), queue_(*job.cones, blocked) {}

  Blocked blocked;
  Horizon horizon;

  /// Looks from receiver i at the lines above its horizon.
  HWY_INLINE void look(int i) {
    horizon.assign(*job_.cones, job_.receivers->normal[i]);
    look(i, horizon.active);
  }

  /// Blocks what lies below the horizon.
  HWY_INLINE void hide_below() {
    const Words d;
    for (int line = 0; line < lines_of(job_.cones->n); ++line) {
      const bool above = horizon.active >> line & 1u;
      if (above && !(horizon.cut >> line & 1u)) continue;
      std::uint32_t* words = Touch(blocked, line);
      const std::uint32_t* below = horizon.below + line * words_per_line;
      for (int w = 0; w < words_per_line; w += int(hn::Lanes(d)))
        hn::Store(above ? hn::Or(hn::Load(d, words + w), hn::Load(d, below + w)) : hn::Set(d, ~0u), d, words + w);
    }
  }

  /// Looks from receiver i at the lines of `active`.
  HWY_INLINE void look(int i, std::uint64_t active) {
    const Receivers& r = *job_.receivers;
    blocked.touched = 0;
    if (job_.rays) {
      traced_.fill(false);
      trace_texels(*job_.rays, r.ray_origin(i), r.normal[i], *job_.directions, true, traced_);
      std::copy(traced_.words.begin(), traced_.words.end(), blocked.words);
      blocked.touched = ~std::uint64_t(0) >> (64 - lines_of(job_.cones->n));
    } else if (!r.on_occluder[i]) {  // an object's own spheres swallow its surface
      const bool outside = job_.table ? merge_table(r.position[i], active) : rasterise(r.position[i], active);
      queue_.flush();
      if (!outside) BlockEverything(blocked, lines_of(job_.cones->n));
    }
  }

 private:
  HWY_INLINE bool rasterise(vec3 x, std::uint64_t active) {
    const SphereLanes& s = *job_.spheres;
    return RasteriseSpheres(*job_.cones, s.x.data(), s.y.data(), s.z.data(), s.radius.data(), s.padded(), x, active,
                            queue_, blocked);
  }

  HWY_INLINE bool merge_table(vec3 x, std::uint64_t active) {
    const TableEntry* all = job_.table->entries().data();
    const std::uint32_t* data = job_.table->data().data();
    const auto seen = std::uint32_t(active);  // tables are of 12 lines at most
    HWY_ALIGN std::int32_t entries[chunk];
    for (int first = 0; first < job_.spheres->padded(); first += chunk) {
      const int count = std::min(chunk, job_.spheres->padded() - first);
      FindEntries(job_, first, count, x, entries);
      for (int i = 0; i < count; ++i) {
        if (entries[i] == blocks_everything) return false;
        if (entries[i] >= 0) hwy::Prefetch(all + entries[i]);
      }
      TableEntry found[chunk];
      for (int i = 0; i < count; ++i) {
        found[i] = entries[i] >= 0 ? all[entries[i]] : TableEntry{0, 0};
        for (std::uint32_t left = found[i].lines & seen; left; left &= left - 1)
          hwy::Prefetch(line_of(found[i], left, data));
      }
      for (int i = 0; i < count; ++i) {
        for (std::uint32_t left = found[i].lines & seen; left; left &= left - 1)
          merge(line_of(found[i], left, data), Touch(blocked, std::countr_zero(left)));
        if (entries[i] == beyond_table) beyond_.add(*job_.spheres, first + i);
      }
      beyond_.rasterise(*job_.cones, x, active, queue_, blocked);
    }
    return true;
  }

  /// Where an entry keeps the first of some of its lines.
  static HWY_INLINE const std::uint32_t* line_of(const TableEntry& entry, std::uint32_t some,
                                                 const std::uint32_t* data) {
    const int before = std::popcount(entry.lines & ((some & -some) - 1u));
    return data + std::size_t(entry.first + std::uint32_t(before)) * words_per_line;
  }

  static HWY_INLINE void merge(const std::uint32_t* from, std::uint32_t* to) {
    const Words d;
    for (int w = 0; w < words_per_line; w += int(hn::Lanes(d)))
      hn::Store(hn::Or(hn::Load(d, to + w), hn::Load(d, from + w)), d, to + w);
  }

  const BlockedJob& job_;
  BitCube traced_;
  RowQueue queue_;
  Beyond beyond_;
};

}  // namespace HWY_NAMESPACE
}  // namespace penumbra
HWY_AFTER_NAMESPACE();

#endif  // include guard that toggles per target
