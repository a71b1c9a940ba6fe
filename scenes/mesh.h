// Triangle meshes: the occluder.
#pragma once

#include "scenes/import/import.h"

namespace penumbra {

template <class Vector>
struct Box {
  Vector low = Vector(0), high = Vector(0);
  Vector centre() const { return (low + high) / typename Vector::value_type(2); }
  Vector extent() const { return high - low; }
};
using Bounds = Box<vec3>;

/// Positions in metres from `origin`; triangles index them counter-clockwise seen from outside. Both may be empty.
/// Coordinates are narrowed to float about an origin that lies near what is looked at, so that neither a mesh far from
/// zero nor a part far away costs precision here.
struct Mesh {
  std::vector<vec3> positions;
  std::vector<uvec3> triangles;
  std::vector<vec3> normals;  ///< unit shading normals, one per position, zero where none is given; empty: none at all
  dvec3 origin{0.0};          ///< where (0, 0, 0) lies in the file's or the scene's coordinates
  bool empty() const { return triangles.empty(); }
};

/// Box around the positions that belong to triangles; a box of size 0 at the origin for an empty mesh.
Bounds bounds(const Mesh& mesh);
Box<dvec3> bounds(const ImportedMesh& mesh);

/// Unit normal of the surface at each vertex: the area-weighted mean of the triangles around; zero where none are.
std::vector<vec3> geometric_normals(const Mesh& mesh);
/// What a vertex is shaded with: the mesh's own normal, or else the geometric one.
std::vector<vec3> vertex_normals(const Mesh& mesh);

/// A place near `centre` to count coordinates from, for things of about `size`: on a lattice of powers of two, so that
/// subtracting it is exact, and zero for what lies within a few sizes of zero.
dvec3 local_origin(dvec3 centre, double size);

/// The mesh in float, about an origin; without one, about one of its own.
Mesh narrowed(const ImportedMesh& mesh, dvec3 origin);
Mesh narrowed(const ImportedMesh& mesh);
/// The mesh in double, counted from zero.
ImportedMesh widened(const Mesh& mesh);

/// Triangles that are so small beside their distance from the origin that float rounds their corners by more than a
/// thousandth of their longest edge.
std::size_t count_coarse(const Mesh& mesh);

/// Adds another mesh that is counted from the same origin. Where only one has normals, the other's are zero.
void append(Mesh& mesh, const Mesh& part);

/// A file's mesh (scenes/import/import.h) about an origin of its own. Throws Error.
Mesh load_mesh(const std::string& path);

/// Throws Error naming `what` if the mesh is empty, indexes past its vertices, or has a non-finite position.
void validate(const Mesh& mesh, const std::string& what);

/// The similarity that `fit` of a scene file asks for: p -> scale * p + offset.
struct Similarity {
  double scale = 1.0;
  dvec3 offset{0.0};
  dvec3 operator()(dvec3 p) const { return scale * p + offset; }
};

/// Scales to `height` (0 keeps the size) and brings the middle to `at`: that of the box, or of its base if it is to
/// stand `on_ground`. Without the ground, heights stay as they are.
Similarity fit_to(const Box<dvec3>& box, double height, bool on_ground, dvec3 at = dvec3(0.0));

}  // namespace penumbra
