// A rectangle of receivers, small enough for a core's cache, and what a soft shadow finds out about them.
#pragma once

#include <algorithm>
#include <vector>

#include "techniques/bases/shadow_map/region.h"

namespace penumbra::shadow_map {

/// Where a receiver lies on the map, texels, its biased depth, m, and region_rise(), m per texel; all 0 where nothing
/// can shadow: nothing seen, behind the light, too far away, or not a number.
struct Projected {
  float x = 0.0f, y = 0.0f, depth = 0.0f, rise = 0.0f;
};

struct Tile {
  int column = 0, row = 0, columns = 0, rows = 0;  ///< in the receivers' image

  // One value per receiver of the tile, in row order.
  std::vector<float> x, y;          ///< on the map, texels
  std::vector<float> depth;         ///< m, less the bias; 0 where nothing can shadow: nothing seen, or behind the light
  std::vector<float> rise;          ///< region_rise(), m per texel; 0 for receivers that do not lie on the mesh
  std::vector<float> width;         ///< full width of the region, texels
  std::vector<Square> square;       ///< that stands for the region; level -1: lit
  std::vector<int> representative;  ///< receiver of the tile whose result this one takes; -1: lit
  std::vector<float> blocker;       ///< mean depth of blockers, m; 0: none
  std::vector<float> visibility;    ///< 0 to 1

  /// Fields hold so many values more than size(), for whole vectors at the end; depth is 0 there.
  static constexpr int padding = 16;

  Projected at(int k) const { return {x[k], y[k], depth[k], rise[k]}; }
  int size() const { return columns * rows; }
  /// Index in the image of row r's first receiver.
  std::size_t first(int r, int image_width) const { return std::size_t(row + r) * image_width + column; }

  void place(int c, int r, int wide, int high) {
    column = c, row = r, columns = wide, rows = high;
    const std::size_t n = std::size_t(size()) + padding;
    for (auto* field : {&x, &y, &depth, &rise, &width, &blocker, &visibility}) field->resize(n);
    square.resize(n), representative.resize(n);
    clear_padding();
  }
  void clear_padding() { std::fill_n(depth.begin() + size(), padding, 0.0f); }
};

}  // namespace penumbra::shadow_map
