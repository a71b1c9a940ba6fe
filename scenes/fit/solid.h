// Meshes that bound a solid: what a sphere fit needs before it can speak of inside and outside.
#pragma once

#include <string>

#include "scenes/mesh.h"

namespace penumbra {

/// What was repaired on the way to a solid.
struct Repairs {
  int degenerate_triangles = 0;  ///< dropped: two corners are the same point
  int double_walls = 0;          ///< dropped: small patches all of whose edges have two other triangles already
  int flipped_triangles = 0;     ///< turned around
  bool any() const { return degenerate_triangles + double_walls + flipped_triangles > 0; }
  std::string describe() const;
};

/// The mesh with equal positions joined, every edge shared by as many triangles of one direction as of the other, and
/// normals pointing out of the solid; of a component inside another one they point into the cavity. Throws Error naming
/// `what` and what is open (edges, holes, a point of the first one) or that a component has one side only.
Mesh make_solid(const Mesh& mesh, const std::string& what, Repairs* repairs = nullptr);

/// Volume enclosed by a solid, cubic metres.
double enclosed_volume(const Mesh& solid);

}  // namespace penumbra
