// Few samples of a region or a lamp, turned or shifted anew at every receiver so that their pattern becomes noise:
// Poisson disc (Mitchell 1991), Vogel's spiral turned by interleaved gradient noise (Jimenez 2014), or a lattice on the
// square, shifted (Cranley & Patterson 1976). Discs have the area of the square.
#pragma once

#include <cmath>
#include <vector>

#include "techniques/bases/random.h"
#include "techniques/bases/shadow_map/tile.h"

namespace penumbra::shadow_map {

enum class Pattern { poisson, vogel, lattice };

/// `count` of them as offsets in region widths: discs of area 1 about 0; the lattice in [0, 1).
std::vector<vec2> make_samples(Pattern kind, int count);

/// Interleaved gradient noise in [0, 1) of a pixel (Jimenez 2014).
PENUMBRA_HD inline float gradient_noise(int x, int y) {
  const float inner = 0.06711056f * float(x) + 0.00583715f * float(y);
  const float outer = 52.9829189f * (inner - std::floor(inner));
  return outer - std::floor(outer);
}

/// Turns or shifts a sample for one receiver: for discs (u, v) is (cosine, sine), for the lattice an offset in [0, 1).
PENUMBRA_HD inline vec2 placed(Pattern kind, vec2 sample, float u, float v) {
  if (kind != Pattern::lattice) return {u * sample.x - v * sample.y, v * sample.x + u * sample.y};
  const vec2 s(sample.x + u, sample.y + v);
  return s - glm::floor(s) - 0.5f;
}

/// The (u, v) of the receiver in column x and row y of its image.
PENUMBRA_HD inline void find_turn(Pattern kind, int x, int y, float& u, float& v) {
  const RandomTriple random = random_triple(std::uint64_t(y) << 32 | std::uint32_t(x), 0);
  if (kind == Pattern::lattice) {
    u = random.x, v = random.y;
    return;
  }
  const float angle = float(2.0 * pi) * (kind == Pattern::vogel ? gradient_noise(x, y) : random.x);
  u = std::cos(angle), v = std::sin(angle);
}

/// What turns or shifts the samples of each receiver of a tile: see placed(). Padded for whole vectors, as a tile is.
struct Turns {
  std::vector<float> u, v;
};
void find_turns(Pattern kind, const Tile& tile, Turns& turns);

}  // namespace penumbra::shadow_map
