// The surface of what overlapping, touching and doubled shells enclose together.
#pragma once

#include <string>

#include "scenes/mesh.h"

namespace penumbra {

/// Triangles to a mesh whose winding number is 1 wherever the given one's is positive, and 0 elsewhere: what lies
/// inside goes, triangles that cross or touch others are cut along them, and of coincident ones one stays. Walls
/// without thickness stay where they stand in the open. The mesh itself, bit for bit, where nothing overlaps or
/// touches but a crease of less than 1e-4 of the surface. `mesh`: closed and oriented. `dropped` counts triangles that
/// went, wholly or in part. Throws Error naming `what` if it encloses nothing and has no wall, or if it overlaps itself
/// more than memory holds.
Mesh union_surface(const Mesh& mesh, const std::string& what, int* dropped = nullptr);

/// The mesh without walls of no thickness: without pairs of the same triangle turned both ways.
Mesh without_walls(const Mesh& mesh);

}  // namespace penumbra
