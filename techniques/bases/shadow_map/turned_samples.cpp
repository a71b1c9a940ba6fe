#include "techniques/bases/shadow_map/turned_samples.h"

#include <cmath>

#include "techniques/bases/random.h"
#include "techniques/bases/shadow_map/samples.h"

namespace penumbra::shadow_map {

std::vector<vec2> make_samples(Pattern kind, int count) {
  if (kind == Pattern::lattice) return lattice_square(count);
  std::vector<vec2> samples = kind == Pattern::poisson ? poisson_disc(count) : vogel_disc(count);
  for (vec2& s : samples) s /= float(std::sqrt(pi));  // a disc of area 1
  return samples;
}

void find_turns(Pattern kind, const Tile& tile, Turns& turns) {
  auto& [u, v] = turns;
  u.resize(std::size_t(tile.size()) + Tile::padding), v.resize(u.size());
  for (int k = 0; k < tile.size(); ++k) {
    const int x = tile.column + k % tile.columns, y = tile.row + k / tile.columns;
    const RandomTriple random = random_triple(std::uint64_t(y) << 32 | std::uint32_t(x), 0);
    if (kind == Pattern::lattice) {
      u[k] = random.x, v[k] = random.y;
      continue;
    }
    const float angle = float(2.0 * pi) * (kind == Pattern::vogel ? gradient_noise(x, y) : random.x);
    u[k] = std::cos(angle), v[k] = std::sin(angle);
  }
}

}  // namespace penumbra::shadow_map
