// What the vectorised search for blocked texels works on (bases/blocked-inl.h).
#pragma once

#include <vector>

#include "scenes/receivers.h"
#include "techniques/bases/pixel_sum.h"
#include "techniques/bases/sphere_table.h"

namespace penumbra {

/// Spheres as separate coordinates, padded with radius 0 to a multiple of 16.
struct SphereLanes {
  std::vector<float> x, y, z, radius;
  void assign(const SphereSet& set);
  int padded() const { return int(x.size()); }
};

/// Texel centres as separate coordinates, and a bounding cone of each line of 512 texels.
struct LineCones {
  int n = 0;
  std::vector<float> row_centre;  ///< coordinate of a face's rows, padded to a multiple of 16
  std::vector<float> direction[3];
  std::vector<vec3> axis;
  std::vector<float> sine, cosine;
  Cone cone(std::size_t line) const { return {axis[line], sine[line], cosine[line]}; }
  void assign(int edge, const std::vector<vec3>& directions);
};

/// Bit k is set where line k may have a texel above the horizon of the normal.
std::uint64_t lines_above_horizon(const LineCones& cones, vec3 normal);

struct BlockedJob {
  const Receivers* receivers;
  const SphereLanes* spheres;
  const LineCones* cones;
  const SphereTable* table;             ///< null: rasterise exactly
  const RayScene* rays;                 ///< not null: trace the mesh instead of spheres
  const std::vector<vec3>* directions;  ///< for rays
  const std::vector<int>* order;        ///< receivers in 8 x 8 tiles: neighbours look up the same table entries
};

/// Indices of width x height receivers, tile after tile.
std::vector<int> tile_order(int width, int height);

}  // namespace penumbra
