// Caps as intervals of columns: which texels of a row a cap covers, at one square root a row instead of a dot product a
// texel. Bits are those of covers().
//
// The row with coordinate t of a face with axes M, S (right) and T (down) has the directions M + t T + s S. With the
// cap's axis v and cosine C, k = v.M + t v.T and a = v.S, a texel is covered where
//   k + a s >= C sqrt(1 + t^2 + s^2),   that is   q s^2 + 2 k a s + (k^2 - C^2 (1 + t^2)) >= 0  with  q = a^2 - C^2,
// on the cap's side of the cone: between the roots (-k a -+ C sqrt(k^2 + q (1 + t^2))) / q if q < 0, from one of them
// outward otherwise. A half space is the cap with C = 0.
#pragma once

#include "scenes/cube_map.h"
#include "techniques/bases/cap.h"

namespace penumbra {

/// A cap on a face: products of its axis with the face's axes, which are axes of the cube.
struct CapOnFace {
  float major, down, right, cosine;
};
PENUMBRA_HD inline CapOnFace on_face(const Cap& cap, int face) {
  const vec3 m = cube_direction(face, 0.0f, 0.0f), s = cube_direction(face, 1.0f, 0.0f),
             t = cube_direction(face, 0.0f, 1.0f);
  return {dot_in_order(cap.axis, m), dot_in_order(cap.axis, t - m), dot_in_order(cap.axis, s - m), cap.cosine};
}

/// Columns [first, end) of a row.
struct ColumnRange {
  int first, end;
  bool unsure;  ///< an end lies too near to a texel's centre to trust its rounding: test the texels
};

/// How near to a texel's centre, in columns, an end may lie: rounding moves it by less. Where the cap only just reaches
/// the row, the discriminant being less than `grazing` k^2, it moves it further; and where the roots are the difference
/// of numbers beyond `cancelling`, too far.
inline constexpr float column_margin = 2e-4f, grazing = 1e-3f, grazing_margin = 0.05f, cancelling = 32.0f;

/// Columns that a cap of at most 90 degrees covers of the row at t, on faces of n x n texels.
PENUMBRA_HD inline ColumnRange columns_of(const CapOnFace& cap, float t, int n) {
  const float a = cap.right, c = cap.cosine, q = a * a - c * c, k = cap.major + t * cap.down, k2 = k * k;
  if (q == 0.0f) return {0, 0, true};
  const float discriminant = k2 + q * (1.0f + t * t), inverse = 1.0f / q;
  if (q < 0.0f && !(k > 0.0f && discriminant >= -1e-5f * k2)) return {0, 0, false};
  const float middle = -(k * a) * inverse, half = c * std::sqrt(discriminant > 0.0f ? discriminant : 0.0f) * inverse;
  const float one = middle - half, other = middle + half;
  const float lower = one < other ? one : other, upper = one < other ? other : one;
  const auto column = [&](float s) {  // column c has its centre at c
    const float x = (s + 1.0f) * (0.5f * float(n)) - 0.5f;
    return x > -1.0f ? x < float(n) ? x : float(n) : -1.0f;
  };
  const float low = q < 0.0f ? column(lower) : a > 0.0f ? column(upper) : -1.0f;
  const float high = q < 0.0f ? column(upper) : a > 0.0f ? float(n) : column(lower);
  const float margin = std::abs(discriminant) < grazing * k2 ? grazing_margin : column_margin;
  const auto sure = [&](float x) { return x == -1.0f || x == float(n) || std::abs(x - std::nearbyint(x)) > margin; };
  const int first = int(std::ceil(low)), end = int(std::floor(high)) + 1;
  return {first > 0 ? first : 0, end < n ? end : n, !(sure(low) && sure(high) && std::abs(half) < cancelling)};
}

}  // namespace penumbra
