// Rays against a mesh, through Embree. The only place that knows Embree's version.
#pragma once

#include <memory>
#include <span>

#include "scenes/sphere_set.h"

namespace penumbra {

struct Hit {
  float distance;     ///< along the (unit) direction; infinity if nothing was hit
  unsigned triangle;  ///< index into the mesh's triangles
  float u, v;         ///< barycentric weights of the triangle's second and third vertex
  vec3 normal;        ///< geometric, not normalised, counter-clockwise side
  explicit operator bool() const { return distance < std::numeric_limits<float>::infinity(); }
};

struct Nearest {
  float distance;
  vec3 point;
};

/// Up to 16 rays as separate coordinates.
struct RayPacket {
  static constexpr int size = 16;
  alignas(64) float origin[3][size];
  alignas(64) float direction[3][size];
  alignas(64) float far[size];

  void set(int i, vec3 from, vec3 towards, float reach) {
    for (int c = 0; c < 3; ++c) origin[c][i] = from[c], direction[c][i] = towards[c];
    far[i] = reach;
  }
  void copy(int i, const RayPacket& other, int k) {
    for (int c = 0; c < 3; ++c) origin[c][i] = other.origin[c][k], direction[c][i] = other.direction[c][k];
    far[i] = other.far[k];
  }
};

/// Acceleration structure over one mesh. Queries may come from any number of threads.
class RayScene {
 public:
  RayScene();
  explicit RayScene(const Mesh& mesh) : RayScene() { build(mesh); }
  ~RayScene();
  RayScene(RayScene&&) noexcept;
  RayScene& operator=(RayScene&&) noexcept;

  /// (Re)builds for a mesh; an empty mesh blocks nothing.
  void build(const Mesh& mesh);
  /// The same for spheres, exactly; a hit's `triangle` is then the sphere's index among those with a radius.
  void build(const SphereSet& set);

  Hit intersect(vec3 origin, vec3 direction, float near = 0.0f) const;
  /// Is anything between origin and origin + far * direction?
  bool occluded(vec3 origin, vec3 direction, float far) const;
  /// The same for the first `count` rays of a packet; bit i of the result belongs to ray i.
  /// `alike`: they start nearby and point nearly the same way, and are worth a walk together.
  unsigned occluded(const RayPacket& packet, int count, bool alike = false) const;
  /// Distance of the first hit for the first `count` rays of a packet, in lengths of their directions, which need not
  /// be unit; infinity where nothing is within `far`. The rays are alike.
  void first_hits(const RayPacket& packet, int count, float* distance) const;
  /// Rays that meet the mesh's box; the others are not occluded. Most shadow rays of a plane miss it, and a look at
  /// sixteen at once costs less than a visit to the tree's root.
  unsigned meets_box(const RayPacket& packet, int count) const;

  /// The surface's point that is nearest to a point; distance infinity if it is more than `most`, metres.
  Nearest nearest(vec3 point, float most) const;

  /// Where rays of a surface point start: lifted along its normal by 1e-4 of the mesh's diagonal. Every ray-traced
  /// technique and rung uses it, so that none sees a contact that another does not.
  vec3 lift(vec3 position, vec3 normal) const { return position + lift_ * normal; }

  std::size_t bytes() const;  ///< memory held by Embree for this scene

 private:
  struct Impl;
  void begin(const Bounds& box);
  void commit();
  std::unique_ptr<Impl> impl_;
  float lift_ = 0.0f;
  Bounds box_;
};

/// Is the point inside the closed mesh? Majority of the parities of three axis-aligned rays, so that a small hole or a
/// wrongly oriented triangle does not decide.
bool inside(const RayScene& scene, vec3 point);

}  // namespace penumbra
