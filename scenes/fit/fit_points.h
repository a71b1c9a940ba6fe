// The points that a covering set of spheres must hold, in cells that touch.
#pragma once

#include <vector>

#include "scenes/fit/solid_rows.h"

namespace penumbra {

struct FitPoints {
  std::vector<vec3> position;                ///< vertices, triangle centroids, cell centres inside; sorted by cell
  std::vector<int> first;                    ///< cell c holds points first[c] ... first[c + 1] - 1
  std::vector<std::vector<int>> neighbours;  ///< of each cell: occupied ones among the 26 around it

  int size() const { return int(position.size()); }
  int cells() const { return int(neighbours.size()); }
};

/// The points of a solid, on a lattice of `spacing` metres; inside points only where the rows know of them.
FitPoints sample_points(const Mesh& solid, const SolidRows& rows, double spacing);

/// Centres of lattice cells that lie inside.
std::vector<vec3> interior_points(const SolidRows& rows, double spacing);

}  // namespace penumbra
