// Procedural meshes: always there, and several with a known shadow.
#pragma once

#include "scenes/mesh.h"

namespace penumbra {

Mesh make_sphere(vec3 centre, float radius, int segments = 192);  ///< closed; 2 x segments x segments / 2 triangles
Mesh make_box(vec3 low, vec3 high);                               ///< closed, 12 triangles
Mesh make_torus_knot(int p = 2, int q = 3, int along = 512, int around = 24);  ///< closed (p, q) tube, height about 2
Mesh make_torus(float major, float minor, int along, int around);              ///< closed, axis y
Mesh make_bowl(float radius, int segments = 96);  ///< lower hemisphere about the origin, normals inward, open at y = 0

/// The shapes a scene file may name: "torus-knot" "torus" "sphere" "resting-sphere" "box" "bowl"; false if unknown.
bool make_shape(const std::string& name, Mesh& mesh);
inline constexpr const char* shape_names = "torus-knot, torus, sphere, resting-sphere, box, bowl, none";

}  // namespace penumbra
