// Procedural meshes: always there, and several with a known shadow.
#pragma once

#include "scenes/mesh.h"

namespace penumbra {

Mesh make_sphere(vec3 centre, float radius, int segments = 192);  ///< closed; 2 x segments x segments / 2 triangles
Mesh make_box(vec3 low, vec3 high);                               ///< closed, 12 triangles
Mesh make_torus_knot(int p = 2, int q = 3, int along = 512, int around = 24);  ///< closed (p, q) tube, height about 2
Mesh make_torus(float major, float minor, int along, int around);              ///< closed, axis y
Mesh make_bowl(float radius, int segments = 96);  ///< lower hemisphere about the origin, normals inward, open at y = 0

Mesh make_still_life();                      ///< a ball, a box and a ring on y = 0
Mesh make_fence(int bars, float thickness);  ///< upright bars between two rails, width 2, height 1, on y = 0
Mesh make_two_blockers();                    ///< two thin plates that overlap, at heights 0.4 and 1.4
/// `count` boxes, balls and rings of 0.1 to 0.5 m at random places and angles, within 2 m of the y axis and up to
/// height 2. The same seed gives the same mesh on every machine.
Mesh make_primitives(unsigned seed, int count = 40);

/// A shrub of seven stems on y = 0, about 2 high, with some three thousand leaves; closed. The seed as above.
Mesh make_foliage(unsigned seed);

/// The shapes a scene file may name; false if unknown. The seed is for those that grow from one.
bool make_shape(const std::string& name, Mesh& mesh, unsigned seed = 1);
bool has_seed(const std::string& shape);
inline constexpr const char* shape_names =
    "torus-knot, torus, sphere, resting-sphere, box, bowl, still-life, fence, two-blockers, primitives, foliage, none";

}  // namespace penumbra
