// Intervals of columns (bases/cap_rows.h), a lane a row: spheres and horizons into bits. Included once per instruction
// set (Highway's -inl.h pattern).
#if defined(PENUMBRA_CAP_ROWS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef PENUMBRA_CAP_ROWS_INL_H_
#undef PENUMBRA_CAP_ROWS_INL_H_
#else
#define PENUMBRA_CAP_ROWS_INL_H_
#endif

#include <hwy/highway.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>

#include "techniques/bases/blocked.h"
#include "techniques/bases/cap_rows.h"

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

// --- one cap on one face ---------------------------------------------------------------------------------------------

/// CapOnFace and the row's coordinate, a row in each lane.
struct RowLanes {
  VF major, down, right, cosine, t;
  static HWY_INLINE RowLanes of(const CapOnFace& cap, VF t) {
    const Floats d;
    return {hn::Set(d, cap.major), hn::Set(d, cap.down), hn::Set(d, cap.right), hn::Set(d, cap.cosine), t};
  }
};

/// ColumnRange of some rows.
struct Columns {
  VF first, end;
  hn::Mask<Floats> unsure;
};

/// columns_of(), operation by operation.
HWY_INLINE Columns ColumnsOf(const RowLanes& row, int n) {
  const Floats d;
  const VF zero = hn::Zero(d), one = hn::Set(d, 1.0f), a = row.right;
  const VF q = hn::Sub(hn::Mul(a, a), hn::Mul(row.cosine, row.cosine));
  const VF k = hn::Add(row.major, hn::Mul(row.t, row.down)), k2 = hn::Mul(k, k);
  const VF discriminant = hn::Add(k2, hn::Mul(q, hn::Add(one, hn::Mul(row.t, row.t))));
  const VF inverse = hn::Div(one, q);
  const VF middle = hn::Mul(hn::Neg(hn::Mul(k, a)), inverse);
  const VF half = hn::Mul(hn::Mul(row.cosine, hn::Sqrt(hn::Max(discriminant, zero))), inverse);
  const VF one_end = hn::Sub(middle, half), other_end = hn::Add(middle, half);
  const VF low_end = hn::Min(one_end, other_end), high_end = hn::Max(one_end, other_end);

  const VF half_n = hn::Set(d, 0.5f * float(n)), centre = hn::Set(d, 0.5f), before = hn::Set(d, -1.0f),
           after = hn::Set(d, float(n));
  const auto column = [&](VF s) HWY_ATTR {
    return hn::Clamp(hn::Sub(hn::Mul(hn::Add(s, one), half_n), centre), before, after);
  };
  const VF lower = column(low_end), upper = column(high_end);
  const auto between = hn::Lt(q, zero), rightward = hn::Gt(a, zero);
  const VF low = hn::IfThenElse(between, lower, hn::IfThenElse(rightward, upper, before));
  const VF high = hn::IfThenElse(between, upper, hn::IfThenElse(rightward, after, lower));

  const auto grazes = hn::Lt(hn::Abs(discriminant), hn::Mul(hn::Set(d, grazing), k2));
  const VF margin = hn::IfThenElse(grazes, hn::Set(d, grazing_margin), hn::Set(d, column_margin));
  const auto sure = [&](VF x) HWY_ATTR {
    return hn::Or(hn::Gt(hn::Abs(hn::Sub(x, hn::Round(x))), margin), hn::Or(hn::Eq(x, before), hn::Eq(x, after)));
  };
  const auto meets =
      hn::Or(hn::Ge(q, zero), hn::And(hn::Gt(k, zero), hn::Ge(discriminant, hn::Mul(hn::Set(d, -1e-5f), k2))));
  const auto trusted = hn::And(hn::And(sure(low), sure(high)), hn::Lt(hn::Abs(half), hn::Set(d, cancelling)));
  Columns out;
  out.unsure = hn::Or(hn::AndNot(trusted, meets), hn::Eq(q, zero));
  const auto take = hn::AndNot(out.unsure, meets);
  out.first = hn::IfThenElseZero(take, hn::Max(hn::Ceil(low), zero));
  out.end = hn::IfThenElseZero(take, hn::Min(hn::Add(hn::Floor(high), one), after));
  return out;
}

/// Texels of one row that a cap covers, each by its dot product: up to 64 bits.
HWY_INLINE std::uint64_t TestRow(const LineCones& cones, const Cap& cap, int first_texel) {
  const Floats d;
  const int lanes = int(hn::Lanes(d));
  const VF vx = hn::Set(d, cap.axis.x), vy = hn::Set(d, cap.axis.y), vz = hn::Set(d, cap.axis.z);
  const VF cosine = hn::Set(d, cap.cosine);
  std::uint64_t bits = 0;
  for (int k = 0; k < cones.n; k += lanes) {
    const int t = first_texel + k;
    const VF dot = hn::Add(
        hn::Add(hn::Mul(hn::LoadU(d, &cones.direction[0][t]), vx), hn::Mul(hn::LoadU(d, &cones.direction[1][t]), vy)),
        hn::Mul(hn::LoadU(d, &cones.direction[2][t]), vz));
    std::uint8_t packed[8] = {};
    hn::StoreMaskBits(d, hn::Ge(dot, cosine), packed);
    std::uint64_t part;
    std::memcpy(&part, packed, sizeof part);
    bits |= (part & ((std::uint64_t(1) << lanes) - 1u)) << k;
  }
  return bits;
}

/// ORs the bits of a row into the words of a cube.
HWY_INLINE void OrRow(std::uint32_t* words, int first_texel, int n, std::uint64_t bits) {
  std::uint32_t* word = words + first_texel / 32;
  word[0] |= std::uint32_t(bits) << (first_texel % 32);
  if (n == 64) word[1] |= std::uint32_t(bits >> 32);
}

/// Bits of columns [first, end) of rows of 32.
HWY_INLINE hn::Vec<Words> RowBits(const Columns& columns) {
  const Ints di;
  const Words dw;
  const auto one = hn::Set(di, 1), whole = hn::Set(di, 32), last = hn::Set(di, 31);
  const auto first = hn::ConvertTo(di, columns.first), end = hn::ConvertTo(di, columns.end);
  const auto from = hn::Shl(hn::Set(dw, ~0u), hn::BitCast(dw, hn::Min(first, last)));
  const auto to = hn::Shr(hn::Set(dw, ~0u), hn::BitCast(dw, hn::Sub(whole, hn::Max(end, one))));
  return hn::IfThenElseZero(hn::RebindMask(dw, hn::Lt(first, end)), hn::And(from, to));
}

/// Calls or_row(lane, bits) for rows whose columns are known, test_row(lane) for the others. Lanes from `count` on are
/// left alone.
template <class Known, class Unsure>
HWY_INLINE void ForRows(const Columns& columns, int n, int count, Known or_row, Unsure test_row) {
  const Floats d;
  const Ints di;
  if (n == 32) {
    HWY_ALIGN std::uint32_t bits[HWY_MAX_BYTES / 4];
    hn::Store(RowBits(columns), Words(), bits);
    for (int k = 0; k < count; ++k) or_row(k, std::uint64_t(bits[k]));
  } else {
    HWY_ALIGN std::int32_t first[HWY_MAX_BYTES / 4], end[HWY_MAX_BYTES / 4];
    hn::Store(hn::ConvertTo(di, columns.first), di, first);
    hn::Store(hn::ConvertTo(di, columns.end), di, end);
    for (int k = 0; k < count; ++k)
      if (first[k] < end[k]) or_row(k, ~std::uint64_t(0) << first[k] & ~std::uint64_t(0) >> (64 - end[k]));
  }
  if (hn::AllFalse(d, columns.unsure)) return;
  std::uint8_t packed[8] = {};
  hn::StoreMaskBits(d, columns.unsure, packed);
  for (unsigned left = (packed[0] | unsigned(packed[1]) << 8) & ((1u << count) - 1u); left; left &= left - 1)
    test_row(std::countr_zero(left));
}

/// ORs what a cap covers of as many rows of a face as there are lanes, from `row` on.
HWY_INLINE void CoverRows(const LineCones& cones, const Cap& cap, int face, int row, std::uint32_t* words) {
  const Floats d;
  const int n = cones.n, first = (face * n + row) * n;
  const RowLanes rows = RowLanes::of(on_face(cap, face), hn::LoadU(d, &cones.row_centre[row]));
  ForRows(
      ColumnsOf(rows, n), n, int(hn::Lanes(d)),
      [&](int k, std::uint64_t bits) HWY_ATTR { OrRow(words, first + k * n, n, bits); },
      [&](int k) HWY_ATTR { OrRow(words, first + k * n, n, TestRow(cones, cap, first + k * n)); });
}

// --- spheres ---------------------------------------------------------------------------------------------------------

/// Rows that caps may reach, of any caps and faces, gathered so that every lane has one.
class RowQueue {
  static constexpr int most = 256, room = 16;

 public:
  HWY_INLINE RowQueue(const LineCones& cones, Blocked& blocked) : cones_(cones), blocked_(blocked) {}

  /// Rows [low, high) of a face. Lines that they lie in must be touched, or nobody's concern.
  HWY_INLINE void push(const CapOnFace& cap, int face, int low, int high) {
    const hn::CappedTag<float, 8> d;  // most caps have no more rows
    const hn::RebindToSigned<decltype(d)> di;
    const int lanes = int(hn::Lanes(d)), n = cones_.n;
    HWY_ALIGN static constexpr std::int32_t from_0[8] = {0, 1, 2, 3, 4, 5, 6, 7};
    const auto next = hn::Load(di, from_0);  // hn::Iota() goes through memory
    if (count_ > most - n) flush();
    int at = count_;
    for (int row = low; row < high; row += lanes, at += lanes) {
      hn::StoreU(hn::Set(d, cap.major), d, major_ + at);
      hn::StoreU(hn::Set(d, cap.down), d, down_ + at);
      hn::StoreU(hn::Set(d, cap.right), d, right_ + at);
      hn::StoreU(hn::Set(d, cap.cosine), d, cosine_ + at);
      hn::StoreU(hn::Add(next, hn::Set(di, face * n + row)), di, row_ + at);
    }
    count_ += high - low;
  }

  HWY_NOINLINE void flush() {
    const Floats d;
    const Ints di;
    const int lanes = int(hn::Lanes(d)), n = cones_.n;
    for (int i = 0; i < count_; i += lanes) {
      const auto row = hn::And(hn::LoadU(di, row_ + i), hn::Set(di, n - 1));
      const VF t =
          hn::Sub(hn::Mul(hn::ConvertTo(d, hn::Add(hn::Add(row, row), hn::Set(di, 1))), hn::Set(d, 1.0f / float(n))),
                  hn::Set(d, 1.0f));  // cube_centre(), exactly
      const RowLanes rows{hn::LoadU(d, major_ + i), hn::LoadU(d, down_ + i), hn::LoadU(d, right_ + i),
                          hn::LoadU(d, cosine_ + i), t};
      ForRows(
          ColumnsOf(rows, n), n, std::min(lanes, count_ - i),
          [&](int k, std::uint64_t bits) HWY_ATTR { OrRow(blocked_.words, row_[i + k] * n, n, bits); },
          [&](int k)
              HWY_ATTR { OrRow(blocked_.words, row_[i + k] * n, n, TestRow(cones_, cap_of(i + k), row_[i + k] * n)); });
    }
    count_ = 0;
  }

 private:
  /// The cap of a row, from its products with the face's axes.
  HWY_INLINE Cap cap_of(int i) const {
    const int face = row_[i] / cones_.n;
    const vec3 m = cube_direction(face, 0.0f, 0.0f), s = cube_direction(face, 1.0f, 0.0f),
               t = cube_direction(face, 0.0f, 1.0f);
    return {major_[i] * m + right_[i] * (s - m) + down_[i] * (t - m), cosine_[i]};
  }

  const LineCones& cones_;
  Blocked& blocked_;
  int count_ = 0;
  float major_[most + room] = {}, down_[most + room] = {}, right_[most + room] = {}, cosine_[most + room] = {};
  std::int32_t row_[most + room] = {};  ///< of the cube
};

/// Caps of some spheres, make_cap() operation by operation, and what of a face they can reach.
struct CapLanes {
  VF x, y, z, cosine, sine;
  hn::Mask<Floats> any, everything;  ///< is there a sphere; does the point lie inside it

  HWY_INLINE CapLanes(const float* sx, const float* sy, const float* sz, const float* radius, vec3 at) {
    const Floats d;
    const VF tx = hn::Sub(hn::LoadU(d, sx), hn::Set(d, at.x)), ty = hn::Sub(hn::LoadU(d, sy), hn::Set(d, at.y)),
             tz = hn::Sub(hn::LoadU(d, sz), hn::Set(d, at.z)), r = hn::LoadU(d, radius), one = hn::Set(d, 1.0f);
    const VF d2 = hn::Add(hn::Add(hn::Mul(tx, tx), hn::Mul(ty, ty)), hn::Mul(tz, tz)), r2 = hn::Mul(r, r);
    any = hn::Gt(r2, hn::Zero(d)), everything = hn::AndNot(hn::Lt(r2, d2), any);
    const VF distance = hn::Sqrt(d2), ratio2 = hn::Div(r2, d2);
    x = hn::Div(tx, distance), y = hn::Div(ty, distance), z = hn::Div(tz, distance);
    cosine = hn::Sqrt(hn::Sub(one, ratio2));
    sine = hn::Add(hn::Sqrt(ratio2), hn::Set(d, 1e-5f));
  }

  /// Rows or columns [low, high) that a cap can reach: the tangent planes through the face's other axis. With the cap's
  /// axis (b, w) along t and the face, t is within where (b - t w)^2 <= sin^2 (1 + t^2). Rounding has room.
  HWY_INLINE void range(VF b, VF w, int n, VF& low, VF& high) const {
    const Floats d;
    const VF zero = hn::Zero(d), all = hn::Set(d, float(n)), half_n = hn::Set(d, 0.5f * float(n));
    const VF denominator = hn::Sub(hn::Mul(w, w), hn::Mul(sine, sine));
    const auto bounded = hn::And(hn::Gt(w, zero), hn::Gt(denominator, hn::Set(d, 1e-2f)));
    const VF root = hn::Mul(sine, hn::Sqrt(hn::Max(zero, hn::Add(hn::Mul(b, b), denominator))));
    const VF scale = hn::Div(half_n, denominator), middle = hn::Add(hn::Mul(hn::Mul(b, w), scale), half_n);
    // Row r has its centre at r + 1/2.
    const VF half = hn::Mul(root, scale), centre_and_room = hn::Set(d, 0.55f), one = hn::Set(d, 1.0f);
    const VF from = hn::Ceil(hn::Sub(hn::Sub(middle, half), centre_and_room));
    const VF end = hn::Sub(hn::Ceil(hn::Add(hn::Add(middle, half), centre_and_room)), one);
    low = hn::IfThenElseZero(bounded, hn::Clamp(from, zero, all));
    high = hn::IfThenElse(bounded, hn::Clamp(end, zero, all), all);
  }
};

/// Rows [first, end) of a face.
struct Rows {
  int first, end;
};

/// The rows of each face from the first to the last that lies in a line of `active`.
HWY_INLINE std::array<Rows, 6> RowsOf(std::uint64_t active, int n) {
  std::array<Rows, 6> rows;
  const int step = std::min(n, texels_per_line / n);
  for (int face = 0; face < 6; ++face) {
    rows[face] = {n, 0};
    for (int row = 0; row < n; row += step) {
      if (!(active >> ((face * n + row) * n / texels_per_line) & 1u)) continue;
      rows[face] = {std::min(rows[face].first, row), row + step};
    }
  }
  return rows;
}

/// ORs what `count` spheres cover in the lines of `active`; coordinates are padded with radius 0 to a multiple of 16.
/// Returns false, and covers nothing more, if the point lies inside one.
static HWY_NOINLINE bool RasteriseSpheres(const LineCones& cones, const float* x, const float* y, const float* z,
                                          const float* radius, int count, vec3 at, std::uint64_t active,
                                          RowQueue& queue, Blocked& blocked) {
  const Floats d;
  const Ints di;
  const int n = cones.n, lanes = int(hn::Lanes(d));
  HWY_ALIGN float on_major[HWY_MAX_BYTES / 4], on_down[HWY_MAX_BYTES / 4], on_right[HWY_MAX_BYTES / 4],
      cosine[HWY_MAX_BYTES / 4];
  HWY_ALIGN std::int32_t low[HWY_MAX_BYTES / 4], high[HWY_MAX_BYTES / 4];
  const std::array<Rows, 6> rows_seen = RowsOf(active, n);
  for (int i = 0; i < count; i += lanes) {
    const CapLanes caps(x + i, y + i, z + i, radius + i, at);
    if (!hn::AllFalse(d, caps.everything)) return false;
    hn::Store(caps.cosine, d, cosine);
    // The corners of a face are 54.7 degrees from its centre.
    const VF reach =
        hn::Sub(hn::Sub(hn::Mul(hn::Set(d, 0.57735f), caps.cosine), hn::Mul(hn::Set(d, 0.8165f), caps.sine)),
                hn::Set(d, 1e-5f));
    for (int face = 0; face < 6; ++face) {
      const auto [first_seen, end_seen] = rows_seen[face];
      if (first_seen >= end_seen) continue;
      const auto along = [&](vec3 w) HWY_ATTR {  // an axis of the cube
        const VF v = w.x != 0.0f ? caps.x : w.y != 0.0f ? caps.y : caps.z;
        return w.x + w.y + w.z > 0.0f ? v : hn::Neg(v);
      };
      const vec3 m = cube_direction(face, 0.0f, 0.0f);
      const VF major = along(m), down = along(cube_direction(face, 0.0f, 1.0f) - m),
               right = along(cube_direction(face, 1.0f, 0.0f) - m);
      const auto near = hn::And(caps.any, hn::Ge(major, reach));
      if (hn::AllFalse(d, near)) continue;
      VF top, bottom, left, end;
      caps.range(down, major, n, top, bottom), caps.range(right, major, n, left, end);
      top = hn::Max(top, hn::Set(d, float(first_seen))), bottom = hn::Min(bottom, hn::Set(d, float(end_seen)));
      const auto meets = hn::And(near, hn::And(hn::Lt(top, bottom), hn::Lt(left, end)));
      hn::Store(major, d, on_major), hn::Store(down, d, on_down), hn::Store(right, d, on_right);
      hn::Store(hn::ConvertTo(di, top), di, low), hn::Store(hn::ConvertTo(di, bottom), di, high);
      std::uint8_t packed[8] = {};
      hn::StoreMaskBits(d, meets, packed);
      for (unsigned some = packed[0] | unsigned(packed[1]) << 8; some; some &= some - 1) {
        const int k = std::countr_zero(some);
        bool seen = false;
        for (int line = (face * n + low[k]) * n / texels_per_line;
             line <= (face * n + high[k] - 1) * n / texels_per_line; ++line)
          if (active >> line & 1u) Touch(blocked, line), seen = true;
        if (seen) queue.push({on_major[k], on_down[k], on_right[k], cosine[k]}, face, low[k], high[k]);
      }
    }
  }
  return true;
}

// --- the horizon -----------------------------------------------------------------------------------------------------

/// What a receiver cannot see for its own surface: texels with n . w <= 0, those of the cap of 90 degrees about -n.
struct Horizon {
  vec3 normal{0.0f};
  std::uint64_t active = 0;  ///< lines with a texel above
  std::uint64_t cut = 0;     ///< of these, lines with a texel below
  HWY_ALIGN std::uint32_t below[most_lines * words_per_line];

  HWY_INLINE void assign(const LineCones& cones, vec3 unit_normal) {
    if (normal == unit_normal) return;  // neighbours often share it
    normal = unit_normal;
    active = cut = 0;
    const int lines = lines_of(cones.n);
    std::fill_n(below, lines * words_per_line, 0u);
    for (int line = 0; line < lines; ++line) {
      const std::uint64_t bit = std::uint64_t(1) << line;
      const Cone cone = cones.cone(std::size_t(line));
      if (!above_horizon(cone, unit_normal)) continue;
      if (!above_horizon(cone, -unit_normal)) {
        active |= bit;
        continue;
      }
      HideLine(cones, line);
      const auto [all, any] = AllAndAny(below + line * words_per_line);
      if (all != ~0u) active |= bit;
      if (all != ~0u && any != 0u) cut |= bit;
    }
  }

 private:
  HWY_NOINLINE void HideLine(const LineCones& cones, int line) {
    const Cap cap{-normal, 0.0f};
    const int n = cones.n, rows = texels_per_line / n, lanes = int(hn::Lanes(Floats()));
    for (int row = line * rows / lanes * lanes; row < (line + 1) * rows; row += lanes)
      CoverRows(cones, cap, row / n, row % n, below);
  }

  /// AND and OR of a line's words.
  static HWY_INLINE std::pair<std::uint32_t, std::uint32_t> AllAndAny(const std::uint32_t* words) {
    std::uint32_t all = ~0u, any = 0u;
    for (int w = 0; w < words_per_line; ++w) all &= words[w], any |= words[w];
    return {all, any};
  }
};

}  // namespace HWY_NAMESPACE
}  // namespace penumbra
HWY_AFTER_NAMESPACE();

#endif  // include guard that toggles per target
