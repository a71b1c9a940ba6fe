// Meshes that bound a solid: what a sphere fit needs before it can speak of inside and outside.
#pragma once

#include <string>

#include "scenes/mesh.h"

namespace penumbra {

/// What was repaired on the way to a solid.
struct Repairs {
  int degenerate_triangles = 0;  ///< dropped: two corners are the same point
  int copies = 0;                ///< dropped: the same triangle again
  int double_walls = 0;          ///< dropped: small patches all of whose edges have two other triangles already
  int flipped_triangles = 0;     ///< turned around
  int inner_triangles = 0;       ///< dropped or cut: inside the solid, where parts overlap or touch
  bool any() const { return degenerate_triangles + copies + double_walls + flipped_triangles + inner_triangles > 0; }
  std::string describe() const;
};

/// The surface of the solid that a mesh means: the points where its winding number is positive. Equal positions are
/// joined and normals point out of the solid. Shells that overlap, touch or are there twice count once; a shell inside
/// another is a cavity if it faces the other way (orient_shells, union_surface). Throws Error naming `what` and what is
/// open (edges, holes, a point of the first one) or that a component has one side only.
Mesh make_solid(const Mesh& mesh, const std::string& what, Repairs* repairs = nullptr);

/// Volume enclosed by a solid, cubic metres.
double enclosed_volume(const Mesh& solid);

}  // namespace penumbra
