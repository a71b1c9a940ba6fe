#include "techniques/bases/shadow_map/turned_samples.h"

#include <cmath>

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
  for (int k = 0; k < tile.size(); ++k)
    find_turn(kind, tile.column + k % tile.columns, tile.row + k / tile.columns, u[k], v[k]);
}

}  // namespace penumbra::shadow_map
