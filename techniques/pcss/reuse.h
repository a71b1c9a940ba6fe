// Neighbouring receivers with nearly the same region share one result (Zhu et al. 2019, section 4).
//
// Two receivers are alike if size, centre and depth of their regions differ by at most sigma, relative to the larger
// of both. A receiver is linked to its left neighbour if they are alike, else to its upper one; links do not cross the
// edges of areas of `area` x `area` receivers. The first of a chain, the representative, is computed for all.
#pragma once

#include "techniques/bases/shadow_map/tile.h"

namespace penumbra::pcss {
using namespace shadow_map;  // NOLINT: its base

struct Reuse {
  int area = 1;  ///< receivers along an edge; 1: everyone for itself
  float sigma_size = 0.0f, sigma_place = 0.1f, sigma_depth = 0.1f;
  bool place_by_size = false;  ///< centres: relative to the region's size, not to their coordinates on the map
  bool literal = false;        ///< the paper's sentence: no links at all in an area's first row and column
};

/// |a - b| <= sigma * max(a, b), for a, b >= 0; equal values, 0 and 0 among them, are alike.
PENUMBRA_HD inline bool alike(float a, float b, float sigma) {
  return std::abs(a - b) <= sigma * (a > b ? a : b);
}

/// A region as it is compared.
struct RegionKey {
  float x, y, size, depth;
  bool rises = false;  ///< its bias grows with its regions
};

PENUMBRA_HD inline bool alike(const RegionKey& a, const RegionKey& b, const Reuse& how) {
  if (a.rises != b.rises || !alike(a.size, b.size, how.sigma_size) || !alike(a.depth, b.depth, how.sigma_depth))
    return false;
  if (!how.place_by_size) return alike(a.x, b.x, how.sigma_place) && alike(a.y, b.y, how.sigma_place);
  const float reach = how.sigma_place * (a.size > b.size ? a.size : b.size);
  return std::abs(a.x - b.x) <= reach && std::abs(a.y - b.y) <= reach;
}

/// Centre and size of a receiver's region: of its square if it has one.
PENUMBRA_HD inline RegionKey region_key(const Projected& at, float width, const Square& s) {
  const bool rises = at.rise > 0.0f;
  if (s.level < 0) return {at.x, at.y, width, at.depth, rises};
  const float half = 0.5f * float(s.edge());
  return {float(s.left) + half, float(s.top) + half, 2.0f * half, at.depth, rises};
}
inline RegionKey region_key(const Tile& tile, int k) {
  return region_key(tile.at(k), tile.width[k], tile.square[k]);
}

/// Fills tile.representative; receivers whose entry is -1 before stay so. Areas are those of the whole image: tiles
/// start at multiples of the area.
void link(const Reuse& how, Tile& tile);

}  // namespace penumbra::pcss
