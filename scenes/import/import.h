// Meshes from files, as the files mean them: in double, at the file's place and in its unit.
#pragma once

#include <string>
#include <vector>

#include "scenes/math.h"

namespace penumbra {

struct ImportedMesh {
  std::vector<dvec3> positions;  ///< node transforms applied; every one belongs to a triangle
  std::vector<uvec3> triangles;  ///< counter-clockwise seen from where the file's normals point to, if it has any
  std::vector<vec3> normals;  ///< unit, one per position, zero where the file gives none; empty if it gives none at all
};

/// Every triangle of a mesh file (OBJ, PLY, glTF, 3DS, OFF, STL and what else Assimp reads); polygons are triangulated,
/// points and lines left out, and vertices joined where position and normal are equal.
/// Throws Error naming the file if it is missing, unreadable, without triangles, holds a non-finite vertex, or requires
/// what is not understood.
ImportedMesh import_mesh(const std::string& path);

}  // namespace penumbra
