#include "techniques/bases/haar.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace penumbra::haar {

double tripling_coefficient(int u, int v, int w) {
  int f[3] = {u, v, w};
  std::sort(f, f + 3);  // the scale first, then coarse to fine
  if (f[2] == 0) return 1.0;
  const Place c = place_of(f[2]);
  if (f[0] == 0) return f[1] == f[2] ? 1.0 : 0.0;
  const Place a = place_of(f[0]), b = place_of(f[1]);
  const auto same = [](Square s, Square t) { return s.level == t.level && s.i == t.i && s.j == t.j; };
  if (same(a.square, b.square) && same(b.square, c.square))
    return a.mother != b.mother && b.mother != c.mother && a.mother != c.mother ? double(1 << a.square.level) : 0.0;
  // Two equal wavelets, and one strictly coarser over them: its constant value there.
  if (f[1] != f[2] || a.square.level >= c.square.level) return 0.0;
  const int up = c.square.level - a.square.level;
  if (c.square.i >> up != a.square.i || c.square.j >> up != a.square.j) return 0.0;
  const int qx = c.square.i >> (up - 1) & 1, qy = c.square.j >> (up - 1) & 1;
  return double(1 << a.square.level) * sign_of(a.mother, qx, qy);
}

BinaryTable::BinaryTable() {
  for (unsigned block = 0; block < 65536; ++block) {
    float pixels[16];
    for (int k = 0; k < 16; ++k) pixels[k] = float(block >> k & 1u);
    const std::vector<float> c = transform(std::span<const float>(pixels));
    for (int k = 0; k < 16; ++k) rows_[block][k] = std::int8_t(std::lround(16.0f * c[k]));
  }
}

const BinaryTable& binary_table() {
  static const auto* table = new BinaryTable;  // too large for static storage of every program that links this
  return *table;
}

namespace {

/// Transform of an image of m x m means, in place of `means`, into its coefficients; m is 4, 8 or 16.
void transform_small(float* means, int m, float* out) {
  float next[64];
  for (int half = m / 2, level = levels_of(m) - 1; half >= 1; half /= 2, --level) {
    const float scale = 0.25f / float(half);
    float* coefficients = out + half * half;
    for (int j = 0; j < half; ++j)
      for (int i = 0; i < half; ++i) {
        const float *top = means + 4 * half * j + 2 * i, *low = top + 2 * half;
        const float sum_top = top[0] + top[1], sum_low = low[0] + low[1];
        const float diff_top = top[0] - top[1], diff_low = low[0] - low[1];
        const int k = j * half + i;
        coefficients[k] = scale * (diff_top + diff_low);
        coefficients[k + half * half] = scale * (sum_top - sum_low);
        coefficients[k + 2 * half * half] = scale * (diff_top - diff_low);
        next[k] = 0.25f * (sum_top + sum_low);
      }
    std::copy_n(next, half * half, means);
  }
  out[0] = means[0];
}

}  // namespace

void transform_visibility(const BitCube& blocked, TwoLevel& out) {
  const int n = blocked.n, m = n / 4, per_face = m * m;
  out.n = n;
  out.level1.resize(std::size_t(6) * per_face);
  out.blocks.resize(std::size_t(6) * per_face);
  const BinaryTable& table = binary_table();
  float open[256];
  for (int face = 0; face < 6; ++face) {
    std::uint16_t* blocks = out.blocks.data() + std::size_t(face) * per_face;
    for (int j = 0; j < m; ++j)
      for (int i = 0; i < m; ++i) {
        unsigned block = 0;
        for (int row = 0; row < 4; ++row) {
          const int t = (face * n + 4 * j + row) * n + 4 * i;
          block |= (blocked.words[t >> 5] >> (t & 31) & 15u) << (4 * row);
        }
        blocks[j * m + i] = std::uint16_t(block);
        open[j * m + i] = 1.0f - float(table[block][0]) * (1.0f / 16.0f);
      }
    transform_small(open, m, out.level1.data() + std::size_t(face) * per_face);
  }
}

float coefficient(const TwoLevel& v, int face, int index) {
  return two_level_coefficient(v.level1, v.blocks, binary_table(), v.n, face, index);
}

std::vector<float> coefficients(const TwoLevel& v, int face) {
  std::vector<float> all(std::size_t(v.n) * v.n);
  for (int index = 0; index < int(all.size()); ++index) all[index] = coefficient(v, face, index);
  return all;
}

}  // namespace penumbra::haar
