#include "techniques/ray_traced_denoised/pattern.h"

#include "techniques/bases/random.h"

namespace penumbra::ray_traced_denoised {
namespace {

/// Coordinates of point i as fractions of 2^32: van der Corput's and the second of Sobol's.
struct Digits {
  std::uint32_t x = 0, y = 0;
};
Digits sobol_point(std::uint32_t i) {
  Digits point;
  for (std::uint32_t x = 1u << 31, y = 1u << 31; i != 0; i >>= 1, x >>= 1, y ^= y >> 1)
    if ((i & 1u) != 0) point.x ^= x, point.y ^= y;
  return point;
}

float fraction(std::uint32_t digits) {
  return float(digits >> 8) * 0x1p-24f;
}

}  // namespace

std::vector<vec2> pattern_points(int rays, std::uint64_t seed) {
  const std::uint64_t scramble = mix_bits(seed);
  const auto count = std::uint32_t(pattern_size) * std::uint32_t(rays);
  std::vector<vec2> points;
  points.reserve(count);
  for (std::uint32_t i = 0; i < count; ++i) {
    const Digits point = sobol_point(i);
    points.emplace_back(fraction(point.x ^ std::uint32_t(scramble)), fraction(point.y ^ std::uint32_t(scramble >> 32)));
  }
  return points;
}

}  // namespace penumbra::ray_traced_denoised
