// The two-dimensional, non-standard Haar basis on the faces of a cube map.
//
// A face is the unit square with N = n x n pixels, n = 2^levels. Scale function 1; wavelets
// Psi_M^{l,i,j}(x, y) = 2^l Psi_M(2^l x - i, 2^l y - j), 0 <= l < levels, 0 <= i, j < 2^l, orthonormal; mothers M: 01
// is
// + left - right, 10 is + top - bottom, 11 their product (Zhao & Che 2011, section 3.5; Ng et al. 2004).
// With child means a b / c d of a square: c01 = 2^-l (a - b + c - d) / 4, c10 = 2^-l (a + b - c - d) / 4,
// c11 = 2^-l (a - b - c + d) / 4.
#pragma once

#include <cassert>
#include <cstdint>
#include <span>
#include <vector>

#include "techniques/bases/bit_cube.h"

namespace penumbra::haar {

enum Mother { m01 = 0, m10 = 1, m11 = 2 };

/// A square (l, i, j): i to the right, j downward.
struct Square {
  int level, i, j;
};

/// Coefficients of a face lie as: the scale at 0, then for each level l the three mothers, each 4^l squares in rows.
PENUMBRA_HD constexpr int coefficient_index(Square s, int mother) {
  return (1 << (2 * s.level)) * (1 + mother) + (s.j << s.level) + s.i;
}
struct Place {
  Square square;
  int mother;
};
/// The inverse; index > 0.
PENUMBRA_HD constexpr Place place_of(int index) {
  const int level = (std::bit_width(unsigned(index)) - 1) / 2, squares = 1 << (2 * level);
  const int within = index % squares;
  return {{level, within & ((1 << level) - 1), within >> level}, index / squares - 1};
}

/// Squares of a mean pyramid lie as: level 0, then level 1, ... up to and with the pixels at level `levels`.
PENUMBRA_HD constexpr int pyramid_index(Square s) {
  return ((1 << (2 * s.level)) - 1) / 3 + (s.j << s.level) + s.i;
}
PENUMBRA_HD constexpr int pyramid_size(int levels) {
  return ((1 << (2 * levels + 2)) - 1) / 3;
}
/// log2 n; n is a power of two. Not std::countr_zero: in device code nvcc 13.0 makes the constant 32 of it.
PENUMBRA_HD constexpr int levels_of(int n) {
  assert(std::has_single_bit(unsigned(n)));
  return std::bit_width(unsigned(n)) - 1;
}

/// Sign of mother M on quadrant (qx, qy) of its square.
PENUMBRA_HD constexpr int sign_of(int mother, int qx, int qy) {
  return (mother != m10 && qx ? -1 : 1) * (mother != m01 && qy ? -1 : 1);
}

/// Means of all squares of a face: psum of the paper. psum(X, s) is the mean of X over s, at level `levels` the pixel.
template <class T>
std::vector<T> mean_pyramid(std::span<const T> pixels) {
  const int levels = levels_of(int(std::size_t(1) << (std::countr_zero(pixels.size()) / 2)));
  std::vector<T> means(pyramid_size(levels));
  std::copy(pixels.begin(), pixels.end(), means.begin() + pyramid_index({levels, 0, 0}));
  for (int l = levels - 1; l >= 0; --l)
    for (int j = 0; j < 1 << l; ++j)
      for (int i = 0; i < 1 << l; ++i) {
        const auto child = [&](int qx, int qy) { return means[pyramid_index({l + 1, 2 * i + qx, 2 * j + qy})]; };
        means[pyramid_index({l, i, j})] = (child(0, 0) + child(1, 0) + child(0, 1) + child(1, 1)) / T(4);
      }
  return means;
}

/// Forward transform of one face: N pixels to N coefficients.
template <class T>
std::vector<T> transform(std::span<const T> pixels) {
  const std::vector<T> means = mean_pyramid(pixels);
  const int levels = levels_of(int(std::size_t(1) << (std::countr_zero(pixels.size()) / 2)));
  std::vector<T> out(pixels.size());
  out[0] = means[0];
  for (int l = 0; l < levels; ++l)
    for (int j = 0; j < 1 << l; ++j)
      for (int i = 0; i < 1 << l; ++i) {
        const auto child = [&](int qx, int qy) { return means[pyramid_index({l + 1, 2 * i + qx, 2 * j + qy})]; };
        const T a = child(0, 0), b = child(1, 0), c = child(0, 1), d = child(1, 1), scale = T(0.25) / T(1 << l);
        out[coefficient_index({l, i, j}, m01)] = scale * (a - b + c - d);
        out[coefficient_index({l, i, j}, m10)] = scale * (a + b - c - d);
        out[coefficient_index({l, i, j}, m11)] = scale * (a - b - c + d);
      }
  return out;
}

/// Mean pyramid from coefficients, coarse to fine: the child (qx, qy) of s has the mean
/// psum(s) + 2^l (X01 sx + X10 sy + X11 sx sy). O(N).
template <class T>
std::vector<T> mean_pyramid_of_coefficients(std::span<const T> x) {
  const int levels = levels_of(int(std::size_t(1) << (std::countr_zero(x.size()) / 2)));
  std::vector<T> means(pyramid_size(levels));
  means[0] = x[0];
  for (int l = 0; l < levels; ++l)
    for (int j = 0; j < 1 << l; ++j)
      for (int i = 0; i < 1 << l; ++i) {
        const Square s{l, i, j};
        for (int q = 0; q < 4; ++q) {
          T value = 0;
          for (int m = 0; m < 3; ++m) value += x[coefficient_index(s, m)] * T(sign_of(m, q & 1, q >> 1));
          means[pyramid_index({l + 1, 2 * i + (q & 1), 2 * j + (q >> 1)})] =
              means[pyramid_index(s)] + T(1 << l) * value;
        }
      }
  return means;
}

/// Inverse transform of one face.
template <class T>
std::vector<T> inverse(std::span<const T> x) {
  std::vector<T> means = mean_pyramid_of_coefficients(x);
  return {means.end() - std::ptrdiff_t(x.size()), means.end()};
}

/// Integral of the product of three functions over the unit square, in linear time:
///   p0 L0 V0 + sum_s 2^l sum_perm p_a L_b V_c + sum_{s,M} [p L psum(V) + p V psum(L) + L V psum(p)]
/// (cases 1 to 3 of the tripling theorem, Ng et al. 2004; all six permutations, which the paper's listing misprints).
template <class T>
T triple_product(std::span<const T> p, std::span<const T> light, std::span<const T> v) {
  const auto pp = mean_pyramid_of_coefficients(p), pl = mean_pyramid_of_coefficients(light);
  const auto pv = mean_pyramid_of_coefficients(v);
  double sum = double(p[0] * light[0] * v[0]);
  for (int index = 1; index < int(p.size()); ++index) {
    const auto [s, a] = place_of(index);
    const int b = coefficient_index(s, (a + 1) % 3), c = coefficient_index(s, (a + 2) % 3), mean = pyramid_index(s);
    sum += double(T(1 << s.level) * p[index] * (light[b] * v[c] + light[c] * v[b]));
    sum += double(p[index] * light[index] * pv[mean] + p[index] * v[index] * pl[mean] +
                  light[index] * v[index] * pp[mean]);
  }
  return T(sum);
}

/// Tripling coefficient of three basis functions, straight from the theorem; indices within a face. The oracle.
double tripling_coefficient(int u, int v, int w);

/// Transform of every 4 x 4 binary block. The index has the block's bits row by row, least significant first: bit
/// 4 * row + column. All values are multiples of 1/16, so a byte holds 16 of each: blocked pixels (16 x the mean), then
/// the block's own l = 0 (01, 10, 11), then l = 1 (01, 10, 11, each TL TR BL BR).
class BinaryTable {
 public:
  using Row = std::int8_t[16];
  BinaryTable();
  const Row& operator[](unsigned block) const { return rows_[block]; }
  int at(unsigned block, int entry) const { return rows_[block][entry]; }
  std::size_t bytes() const { return sizeof rows_; }

 private:
  alignas(64) Row rows_[65536];
};
/// Built once, 1 MiB.
const BinaryTable& binary_table();

/// A binary cube map in the two-level store (Zhao & Che 2011, section 3.4): level 1 is the ordinary transform of the
/// image of block means, level 2 the table index of every 4 x 4 block.
struct TwoLevel {
  int n = 0;
  std::vector<float> level1;          ///< 6 faces x (n/4)^2 coefficients: scale and l < levels - 2
  std::vector<std::uint16_t> blocks;  ///< 6 faces x (n/4)^2 blocks in rows
  int blocks_per_face() const { return n * n / 16; }
};

/// Transform of a bit cube through the table. Bits are *blocked*; the result is of V = 1 - blocked.
void transform_visibility(const BitCube& blocked, TwoLevel& out);

/// Coefficient `index` of face `face` from the two levels: arrays of coefficients and of block indices as in TwoLevel,
/// and a table with at(block, entry).
template <class Level1, class Blocks, class Table>
PENUMBRA_HD float two_level_coefficient(const Level1& level1, const Blocks& blocks, const Table& table, int n, int face,
                                        int index) {
  const int m = n / 4, per_face = m * m;
  if (index < per_face) return level1[unsigned(face * per_face + index)];
  const auto [s, mother] = place_of(index);
  const int deep = s.level - levels_of(m);  // 0 or 1 within the block
  const int block = (s.j >> deep) * m + (s.i >> deep);
  const int local = coefficient_index({deep, s.i & deep, s.j & deep}, mother);
  const auto value = float(table.at(blocks[unsigned(face * per_face + block)], local));
  return -value * (1.0f / 16.0f) / float(m);  // V = 1 - blocked: the sign turns; block-local to global: 2^-block_level
}

/// The same from the store.
float coefficient(const TwoLevel& v, int face, int index);

/// All N coefficients of a face.
std::vector<float> coefficients(const TwoLevel& v, int face);

}  // namespace penumbra::haar
