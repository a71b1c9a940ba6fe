// Spheres that follow a deforming mesh.
#pragma once

#include <vector>

#include "scenes/sphere_set.h"

namespace penumbra {

/// How a sphere's centre follows its cluster of vertices; the radius stays.
/// rigid:  by the least-squares rigid motion (Horn 1987)
/// affine: by the least-squares affine motion, that is, as a fixed weighted sum of the vertices
enum class Carry { rigid, affine };

/// Moves spheres along. Every vertex belongs to the sphere whose surface it is nearest to, inside counting as negative
/// distance. Spheres that get fewer than four follow the twelve vertices nearest to their surface.
class SphereCarrier {
 public:
  SphereCarrier() = default;
  SphereCarrier(const Mesh& rest, const SphereSet& set, Carry carry);

  /// Writes the centres that belong to the deformed mesh, whose vertices are those at rest, moved. The bits do not
  /// depend on the number of threads.
  void move(const Mesh& deformed, SphereSet& out) const;

 private:
  struct Member {
    unsigned vertex;
    vec3 offset;   ///< at rest, from the cluster's mean
    float weight;  ///< affine: the centre is the sum of weight * position
  };
  struct Cluster {
    std::vector<Member> members;
    vec3 centre;  ///< at rest, from the cluster's mean
    vec3 rest;    ///< affine: what the weighted sum does not reach, as across a flat cluster
  };
  Carry carry_ = Carry::rigid;
  std::vector<Cluster> clusters_;
};

/// Share of the mesh's area whose triangles have their centroid in a sphere.
double surface_coverage(const Mesh& mesh, const SphereSet& set);

}  // namespace penumbra
