// Rays against a mesh, through Embree. The only place that knows Embree's version.
#pragma once

#include <functional>
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

/// Point of the triangle (a, b, c) that is nearest to p (Ericson 2005, section 5.1.5): by the region of the plane that
/// p lies over.
template <class Vector>
Vector nearest_point(Vector p, Vector a, Vector b, Vector c) {
  using T = typename Vector::value_type;
  const Vector ab = b - a, ac = c - a, ap = p - a, bp = p - b, cp = p - c;
  const T d1 = glm::dot(ab, ap), d2 = glm::dot(ac, ap), d3 = glm::dot(ab, bp), d4 = glm::dot(ac, bp);
  const T d5 = glm::dot(ab, cp), d6 = glm::dot(ac, cp);
  if (d1 <= 0 && d2 <= 0) return a;
  if (d3 >= 0 && d4 <= d3) return b;
  if (d6 >= 0 && d5 <= d6) return c;
  const T va = d3 * d6 - d5 * d4, vb = d5 * d2 - d1 * d6, vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return a + d1 / (d1 - d3) * ab;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return a + d2 / (d2 - d6) * ac;
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) return b + (d4 - d3) / ((d4 - d3) + (d5 - d6)) * (c - b);
  return a + (vb * ab + vc * ac) / (va + vb + vc);
}

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
  /// As build(), for a mesh whose corners moved: while its triangles stay the same, the tree is kept and its boxes are
  /// fitted to them, until they have grown too much (scenes/tree_decay.h). The first call builds a tree that can be.
  void move(const Mesh& mesh);
  /// (Re)builds for spheres, which are met exactly; a hit's `triangle` is the sphere's index among those with a radius.
  void build(const SphereSet& set);

  Hit intersect(vec3 origin, vec3 direction, float near = 0.0f) const;
  /// Is anything between origin and origin + far * direction?
  bool occluded(vec3 origin, vec3 direction, float far) const;
  /// Which of the first `count` rays of a packet are occluded; bit i of the result belongs to ray i.
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

  /// Calls look_at(index) for every triangle whose box comes within `reach` of a point, and perhaps others.
  void triangles_near(vec3 point, float reach, const std::function<void(unsigned)>& look_at) const;

  std::size_t bytes() const;  ///< memory held by Embree for this scene

 private:
  struct Impl;
  void begin(const Bounds& box);
  void build(const Mesh& mesh, bool to_be_moved);
  void commit();
  std::unique_ptr<Impl> impl_;
  Bounds box_;
};

/// Is the point inside the closed mesh? Majority of the parities of three axis-aligned rays, so that a small hole or a
/// wrongly oriented triangle does not decide.
bool inside(const RayScene& scene, vec3 point);

}  // namespace penumbra
