#include "techniques/ray_traced_denoised/tiles.h"

#include <algorithm>

#include "techniques/bases/for_ranges.h"

namespace penumbra::ray_traced_denoised {
namespace {

struct Around {
  float least = std::numeric_limits<float>::infinity();
  bool lit = false, dark = false;
  void add(const Around& other) { least = std::min(least, other.least), lit |= other.lit, dark |= other.dark; }
};

}  // namespace

std::vector<float> spread(const TileMap& tiles, int reach) {
  const auto at = [&](int x, int y) { return std::size_t(y) * std::size_t(tiles.columns) + std::size_t(x); };
  std::vector<Around> along_row(std::size_t(tiles.size()));
  for_ranges(tiles.rows, 16, [&](int begin, int end) {
    for (int y = begin; y < end; ++y)
      for (int x = 0; x < tiles.columns; ++x)
        for (int near = std::max(0, x - reach); near <= std::min(tiles.columns - 1, x + reach); ++near) {
          const std::size_t k = at(near, y);
          along_row[at(x, y)].add({tiles.penumbra[k], tiles.lit[k] != 0, tiles.dark[k] != 0});
        }
  });
  std::vector<float> width(std::size_t(tiles.size()), 0.0f);
  for_ranges(tiles.rows, 16, [&](int begin, int end) {
    for (int y = begin; y < end; ++y)
      for (int x = 0; x < tiles.columns; ++x) {
        Around all;
        for (int near = std::max(0, y - reach); near <= std::min(tiles.rows - 1, y + reach); ++near)
          all.add(along_row[at(x, near)]);
        const float own = tiles.penumbra[at(x, y)];
        const bool has_own = own < std::numeric_limits<float>::infinity();
        const float found = has_own ? own : all.least;
        if (all.lit && all.dark && found < std::numeric_limits<float>::infinity()) width[at(x, y)] = found;
      }
  });
  return width;
}

}  // namespace penumbra::ray_traced_denoised
