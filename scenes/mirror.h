// Mirrors: what a camera sees in them is lit like everything else, so that techniques need to know nothing of them.
#pragma once

#include <optional>
#include <variant>

#include "scenes/sphere_set.h"

namespace penumbra {

/// A parallelogram about its centre, of full edges.
struct MirrorPlane {
  vec3 centre{0.0f}, edge_u{1, 0, 0}, edge_v{0, 1, 0};
};

/// Reflects everything, from both sides; blocks light or not.
struct Mirror {
  std::variant<Sphere, MirrorPlane> shape;
  bool shadow = true;
};

/// Where a ray meets a mirror.
struct Reflection {
  float distance;  ///< along the unit direction, m
  vec3 point;
  vec3 normal;     ///< unit, on the side that the ray comes from
  vec3 direction;  ///< unit, of the reflected ray
};

/// The nearest meeting in front of `origin`. From within a ball its far side is met.
std::optional<Reflection> meet(const Mirror& mirror, vec3 origin, vec3 direction);

/// Of the first `before` metres: which mirror a ray meets, and where.
struct Mirrored {
  std::size_t mirror;
  Reflection at;
};
std::optional<Mirrored> nearest_mirror(const std::vector<Mirror>& mirrors, vec3 origin, vec3 direction, float before);

/// Adds the mirrors that block light to the end of a mesh. Balls become triangles within them.
void add_mirrors(Mesh& mesh, const std::vector<Mirror>& mirrors);
/// The mesh without what add_mirrors() added.
Mesh without_mirrors(Mesh mesh, const std::vector<Mirror>& mirrors);

}  // namespace penumbra
