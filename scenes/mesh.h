// Triangle meshes: the occluder.
#pragma once

#include <string>
#include <vector>

#include "scenes/math.h"

namespace penumbra {

struct Bounds {
  vec3 low{0.0f}, high{0.0f};
  vec3 centre() const { return 0.5f * (low + high); }
  vec3 extent() const { return high - low; }
};

/// Positions in metres; triangles index them counter-clockwise seen from outside. Both may be empty.
struct Mesh {
  std::vector<vec3> positions;
  std::vector<uvec3> triangles;
  bool empty() const { return triangles.empty(); }
};

/// Box around all positions; zero box for an empty mesh.
Bounds bounds(const Mesh& mesh);

/// Unit vertex normals, the area-weighted mean of the triangles around; zero where a vertex has none.
std::vector<vec3> vertex_normals(const Mesh& mesh);

/// Loads every mesh of an OBJ, PLY, 3DS or glTF file into one, node transforms applied, equal vertices joined.
/// Throws Error if the file is missing, unreadable, without triangles, or holds a non-finite vertex.
Mesh load_mesh(const std::string& path);

/// Throws Error naming `what` if the mesh is empty, indexes past its vertices, or has a non-finite position.
void validate(const Mesh& mesh, const std::string& what);

/// The similarity that `fit` of a scene file asks for: p -> scale * p + offset.
struct Similarity {
  float scale = 1.0f;
  vec3 offset{0.0f};
  vec3 operator()(vec3 p) const { return scale * p + offset; }
};

/// Scales to `height` (0 keeps the size), centres on x = z = 0 and, if asked, stands the mesh on y = 0.
Similarity fit_to(const Bounds& box, float height, bool on_ground);

}  // namespace penumbra
