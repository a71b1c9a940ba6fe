// Binary visibility over a cube map: one bit a texel, 1 = blocked (Zhao & Che 2011, section 3.3).
#pragma once

#include <bit>
#include <cstdint>
#include <vector>

#include "scenes/math.h"

namespace penumbra {

/// 6 n n bits; texel t is bit t % 32 of word t / 32. Sixteen words (512 texels) form a line, one cache line of 64
/// bytes: half a face at n = 32. n is 16, 32 or 64, so that lines do not cross faces.
struct BitCube {
  int n = 0;
  std::vector<std::uint32_t> words;

  BitCube() = default;
  explicit BitCube(int edge) : n(edge), words(std::size_t(6) * edge * edge / 32, 0u) {}
  bool test(int texel) const { return words[texel >> 5] >> (texel & 31) & 1u; }
  void set(int texel) { words[texel >> 5] |= 1u << (texel & 31); }
  void fill(bool blocked) { words.assign(words.size(), blocked ? ~0u : 0u); }
  int count() const {
    int bits = 0;
    for (const std::uint32_t w : words) bits += std::popcount(w);
    return bits;
  }
};

inline constexpr int texels_per_line = 512, words_per_line = 16;
inline int lines_of(int n) {
  return 6 * n * n / texels_per_line;
}

}  // namespace penumbra
