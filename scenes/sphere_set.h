// The occluder as a set of spheres: what the dynamic techniques see instead of the mesh.
#pragma once

#include <string>
#include <vector>

#include "scenes/mesh.h"

namespace penumbra {

struct Sphere {
  vec3 centre{0.0f};
  float radius = 0.0f;
};

struct SphereSet {
  std::vector<Sphere> spheres;
  bool empty() const { return spheres.empty(); }
  std::size_t size() const { return spheres.size(); }
};

/// Box around all spheres; zero box for an empty set.
Bounds bounds(const SphereSet& set);

/// Spheres as files hold them: x, y, z, radius in double.
using SphereList = std::vector<glm::dvec4>;
SphereList widened(const SphereSet& set, dvec3 origin);
SphereSet narrowed(const SphereList& list, dvec3 origin);
SphereList transformed(SphereList list, const Similarity& fit);

/// JSON: {"spheres": [[x, y, z, radius], ...]} in the mesh's own coordinates.
/// Throws Error naming file and entry if it is malformed, non-finite or a radius is negative, and if the file has a
/// checksum that does not match.
SphereList read_spheres(const std::string& path);
/// Reads a set that lies near zero, so that float holds it. Throws as read_spheres().
SphereSet load_spheres(const std::string& path);
/// Writes atomically, numbers alone: people may change them. Throws Error on failure.
void save_spheres(const std::string& path, const SphereSet& set, dvec3 origin = dvec3(0.0));
/// Writes a set that lies near zero, with a checksum: what the cache keeps, and nobody is to change.
void store_spheres(const std::string& path, const SphereSet& set);

}  // namespace penumbra
