// The shadow map: least depth per texel, seen from the light's centre (Williams 1978), by rays.
#pragma once

#include <vector>

#include "scenes/ray_scene.h"
#include "techniques/pcss/tile.h"

namespace penumbra::pcss {

struct ShadowMap {
  LightView view;
  std::vector<float> depth;  ///< m along the light's normal; infinity where nothing is; resolution rows of stride()

  int resolution() const { return view.resolution; }
  /// Rows are a cache line longer than the map: texels one above the other then fall into different sets of a cache,
  /// and a vector can be loaded from any texel.
  int stride() const { return view.resolution + 16; }
  std::size_t index(int x, int y) const { return std::size_t(y) * std::size_t(stride()) + std::size_t(x); }
  float at(int x, int y) const { return depth[index(x, y)]; }
};

/// Traces map.view; rays through texel centres, packets of 16, rows in parallel.
void trace(const RayScene& rays, ShadowMap& map);

/// Depth bias of a receiver that lies on a triangle of the mesh, in texels of the map: the plane through it may rise by
/// the tangent of its angle to the light over each of them. Receivers elsewhere need none, the map does not hold them.
PENUMBRA_HD inline float depth_bias(const LightView& view, float texels, vec3 position, vec3 normal, float z) {
  const vec3 to_light = view.centre - position;
  const float cosine = glm::dot(normal, to_light) / glm::length(to_light);
  const float tangent =
      cosine > 0.1f ? std::sqrt(1.0f - cosine * cosine > 0.0f ? 1.0f - cosine * cosine : 0.0f) / cosine : 10.0f;
  return texels * view.texel_at(z) * (1.0f + tangent);
}

/// Where a receiver lies on the map, texels, and its biased depth, m; all 0 where nothing can shadow: nothing seen,
/// behind the light, too far away, or not a number.
struct Projected {
  float x = 0.0f, y = 0.0f, depth = 0.0f;
};
PENUMBRA_HD inline Projected project(const LightView& view, float bias, vec3 p, vec3 normal, bool touches) {
  const float z = view.depth(p);
  if (normal == vec3(0.0f) || !(z > 0.0f)) return {};
  const vec2 at = view.project(p, z);
  const float d = touches ? z - depth_bias(view, bias, p, normal, z) : z;
  if (!(std::abs(at.x) < 1e6f && std::abs(at.y) < 1e6f && d > 0.0f)) return {};
  return {at.x, at.y, d};
}

/// Of a tile's receivers.
void project(const LightView& view, const Receivers& receivers, float bias, Tile& tile);

}  // namespace penumbra::pcss
