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

SphereSet transformed(SphereSet set, const Similarity& fit);

/// JSON: {"spheres": [[x, y, z, radius], ...]} in the mesh's own coordinates.
/// Throws Error naming file and entry if it is malformed, non-finite or a radius is negative.
SphereSet load_spheres(const std::string& path);
void save_spheres(const std::string& path, const SphereSet& set);

/// `count` spheres by k-means (Lloyd) of points inside the closed mesh, each with the radius of the ball that has its
/// cluster's second moment, R = sqrt(5/3 * mean squared distance). Deterministic. Meshes too thin to hold points on a
/// grid of 1/48 of their largest extent use their triangles' centroids. Throws Error if count < 1 or exceeds the
/// points.
SphereSet fit_spheres(const Mesh& mesh, int count);

}  // namespace penumbra
