// What a tile of 4 x 4 pixels knows of its shadow, and what its neighbours tell it: engines keep such tiles, too, to
// skip what is all lit or all dark and to give lit pixels the caster of dark ones beside them.
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

namespace penumbra::ray_traced_denoised {

constexpr int tile_edge = 4;  ///< pixels

struct TileMap {
  int columns = 0, rows = 0;
  std::vector<std::uint8_t> lit, dark;  ///< 1: some ray of the tile arrives, is blocked
  std::vector<float> penumbra;          ///< full width, m, as its own casters make it; infinity without any

  void resize(int image_width, int image_height) {
    columns = (image_width + tile_edge - 1) / tile_edge, rows = (image_height + tile_edge - 1) / tile_edge;
    const std::size_t n = std::size_t(columns) * std::size_t(rows);
    lit.assign(n, 0), dark.assign(n, 0);
    penumbra.assign(n, std::numeric_limits<float>::infinity());
  }
  int size() const { return columns * rows; }
  std::size_t bytes() const { return lit.size() * (2 + sizeof(float)); }
};

/// Penumbra width at every tile, m: its own or, where it has no caster, the least of those up to `reach` tiles away.
/// 0 where tiles up to `reach` away are all lit or all dark, and there is nothing to filter, and where none of them
/// found its caster.
std::vector<float> spread(const TileMap& tiles, int reach);

}  // namespace penumbra::ray_traced_denoised
