// The view of the shadow map: what an area light sees from its centre.
//
// The map is parallel to the light and measured in the light's own edges: a point p of depth z (along the light's
// normal) with coordinates (a, b) in edges lies at q = (a, b) / z. In these coordinates any parallelogram is the unit
// square, so every region is a square of texels. From a receiver of depth d, the light covers at depth z < d a square
// about the receiver's own q of full width
//   W(z) = s (1 / z - 1 / d)      perspective      (Fernando 2005 with the widths in the plane z = 1)
//   W(z) = s / D (d - z)          orthographic, D the depth of the occluder's middle: a light that is far away
// with s = 1 (parallelogram), sqrt(pi) / 2 (disc: the square of equal area), 0 (no area: a hard shadow).
#pragma once

#include "scenes/light.h"
#include "scenes/receivers.h"

namespace penumbra::shadow_map {

struct LightView {
  bool perspective = true;
  vec3 centre{0.0f}, normal{0, -1, 0};
  vec3 edge_u{1, 0, 0}, edge_v{0, 0, 1};      ///< orthonormal where the light has no area
  vec3 across_u{1, 0, 0}, across_v{0, 0, 1};  ///< reciprocal: across_u . edge_u = 1, across_u . edge_v = 0
  vec2 shear{0.0f};                           ///< orthographic: edges sideways per metre of depth
  float spread = 1.0f;                        ///< s, or s / D, in texels
  float near = 0.0f;                          ///< least depth of what may shadow, m; > 0
  float farthest = 0.0f;                      ///< depth of the farthest receiver, m; 0 if none is in front
  vec2 low{0.0f};                             ///< q of the map's corner
  float density = 1.0f;                       ///< texels per unit of q
  int resolution = 1;                         ///< texels along an edge
  float metres = 1.0f;                        ///< longer edge of a texel in space, m per m of depth (orthographic: m)

  PENUMBRA_HD float depth(vec3 p) const { return glm::dot(normal, p - centre); }

  /// Map coordinates in texels of a point of depth z > 0: texel (i, j) covers [i, i + 1) x [j, j + 1).
  PENUMBRA_HD vec2 project(vec3 p, float z) const {
    const vec3 to = p - centre;
    const vec2 ab(glm::dot(across_u, to), glm::dot(across_v, to));
    const vec2 q = perspective ? ab / z : ab - shear * z;
    return (q - low) * density;
  }

  /// Full width in texels that the light covers at depth z, seen from depth d; not positive if z >= d.
  PENUMBRA_HD float width(float z, float d) const { return spread * (perspective ? 1.0f / z - 1.0f / d : d - z); }

  /// The region's width as it is used: not negative, and cut to the map, which holds every blocker that is wanted
  /// unless it is cut itself or its margin is less than 1. `scale` is the c of Zhu et al. 2019.
  PENUMBRA_HD float region(float z, float d, float scale = 1.0f) const {
    const float wanted = scale * width(z, d), most = float(resolution);
    return wanted > 0.0f ? (wanted < most ? wanted : most) : 0.0f;
  }

  /// Of any region that a receiver searches for blockers.
  float widest() const { return farthest > near ? width(near, farthest) : 0.0f; }

  /// Edge of a texel in space at depth z, m.
  PENUMBRA_HD float texel_at(float z) const { return perspective ? metres * z : metres; }

  /// The ray through the middle of a texel; its parameter is the depth.
  vec3 ray_origin(int column, int row) const;
  vec3 ray_direction(int column, int row) const;

 private:
  vec2 middle(int column, int row) const { return low + vec2(float(column) + 0.5f, float(row) + 0.5f) / density; }
};

struct LightViewSettings {
  int resolution = 1024;
  bool perspective = true;
  double light_scale = 1.0;  ///< factor on the light's edges; affects regions only
  double margin = 1.0;       ///< widest region by which the map reaches past the occluder, in widths
};

/// Fits the map to what of the occluder may shadow a receiver, plus the widest region of any receiver, so that no
/// region that sees a blocker is cut. `outside`: vertices in front of the light that the map cannot hold: farther than
/// 80 degrees from the axis, or within a thousandth of its size of the light's plane.
LightView make_light_view(const AreaLight& light, const Mesh& mesh, const Receivers& receivers,
                          const LightViewSettings& settings, std::size_t& outside);

}  // namespace penumbra::shadow_map
