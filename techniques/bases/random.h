// Counter-based random numbers: a pure function of its keys, so images do not depend on threads or order.
#pragma once

#include <cmath>

#include "scenes/math.h"

namespace penumbra {

/// Mixes 64 bits (splitmix64 finaliser, Steele et al. 2014).
PENUMBRA_HD inline std::uint64_t mix_bits(std::uint64_t x) {
  x += 0x9e3779b97f4a7c15ull;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ull;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebull;
  return x ^ (x >> 31);
}

/// Three numbers in [0, 1) for sample `index` of stream `stream`.
struct RandomTriple {
  float x, y, z;
};
PENUMBRA_HD inline RandomTriple random_triple(std::uint64_t stream, std::uint32_t index) {
  const std::uint64_t bits = mix_bits(stream ^ (std::uint64_t(index) * 0xd1342543de82ef95ull));
  const auto unit = [](std::uint64_t b) { return float(b & 0x1fffff) * (1.0f / 2097152.0f); };  // 21 bits
  return {unit(bits), unit(bits >> 21), unit(bits >> 42)};
}

/// Point i of k of Hammersley's set in base 2, shifted by (shift.x, shift.y) on the torus (Cranley & Patterson 1976).
inline vec2 shifted_hammersley(int i, int k, const RandomTriple& shift) {
  std::uint32_t reversed = 0;
  for (std::uint32_t bits = std::uint32_t(i), b = 0; b < 32; ++b) reversed |= (bits >> b & 1u) << (31 - b);
  const float u = (float(i) + 0.5f) / float(k) + shift.x, v = float(reversed >> 8) * 0x1p-24f + shift.y;
  return {u - std::floor(u), v - std::floor(v)};
}

}  // namespace penumbra
