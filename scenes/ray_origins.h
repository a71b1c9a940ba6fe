// Where the rays of a surface point start: the one place that knows how much a float rounds. Truth and techniques share
// it, so that none sees a contact that another does not.
//
// A ray that leaves a surface must not meet it again by rounding. What rounds is the point itself, by some units in its
// last place, and the height of a ray's origin over a triangle, which Embree computes from differences of corners and
// origin: by some units in the last place of the triangle's own size, more for slivers. Nothing else does: not where
// the scene lies beyond the point's own coordinates, not its unit, not what stands elsewhere (cf. Pharr, Jakob &
// Humphreys 2016, section 3.9). So a ray starts at least 4 such units above every triangle that rounding lets it meet.
#pragma once

#include "scenes/ray_scene.h"

namespace penumbra {

/// Finds the start of a point's rays.
class RayOrigins {
 public:
  /// `rays` are of the mesh; both must outlive this.
  RayOrigins(const Mesh& mesh, const RayScene& rays);

  struct Contact {
    float distance;  ///< beside the point, m, at which its rays start; 0 where nothing is near and the point is zero
    bool touches;    ///< the point lies on a triangle of the mesh
  };
  Contact contact(vec3 point) const;

 private:
  /// A triangle whose heights round by up to `bound`, m, in the plane dot(normal, p) = offset.
  struct Face {
    dvec3 normal;
    double offset, bound;
    unsigned triangle;
  };
  Face face(unsigned triangle) const;
  double missing(const Face& face, vec3 point, double own) const;

  const Mesh& mesh_;
  const RayScene& rays_;
  std::vector<Face> broad_;  ///< the few that are so large or thin that they are looked at from everywhere
  double widest_ = 0.0;      ///< largest bound of the others, m
};

}  // namespace penumbra
