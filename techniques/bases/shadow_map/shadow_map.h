// The shadow map: least depth per texel, seen from the light's centre (Williams 1978), by rays.
#pragma once

#include <vector>

#include "scenes/ray_scene.h"
#include "techniques/bases/shadow_map/tile.h"

namespace penumbra::shadow_map {

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

/// Fills the depths of map.view by rays through texel centres, in packets of 16.
void trace(const RayScene& rays, ShadowMap& map);

/// How far receivers on triangles of the mesh are raised so that these do not shadow them. Receivers elsewhere need no
/// bias, the map does not hold them.
struct Bias {
  float texels = 0.0f;  ///< of the map, for every comparison
  float region = 0.0f;  ///< of half the width of the region that is summed, as a share
};

/// Tangent of a receiver's angle to the light: what the plane through it may rise over a length.
PENUMBRA_HD inline float slope_to_light(const LightView& view, vec3 position, vec3 normal) {
  const vec3 to_light = view.centre - position;
  const float cosine = glm::dot(normal, to_light) / glm::length(to_light);
  return cosine > 0.1f ? std::sqrt(1.0f - cosine * cosine > 0.0f ? 1.0f - cosine * cosine : 0.0f) / cosine : 10.0f;
}

/// Depth bias of a receiver that lies on the mesh, in texels of the map: the plane through it may rise by its slope
/// over each of them.
PENUMBRA_HD inline float depth_bias(const LightView& view, float texels, vec3 position, vec3 normal, float z) {
  const float tangent = slope_to_light(view, position, normal);
  return texels * view.texel_at(z) * (1.0f + tangent);
}

/// The bias that grows with the region: `share` of what the plane through a receiver rises from the region's middle to
/// its edge, for each texel of the region's full width. Steeper receivers count as if at 56 degrees: what their regions
/// hold is mostly real.
constexpr float steepest_rise = 1.5f;
PENUMBRA_HD inline float region_rise(const LightView& view, float share, vec3 position, vec3 normal, float z) {
  const float tangent = slope_to_light(view, position, normal);
  return 0.5f * share * view.texel_at(z) * (tangent < steepest_rise ? tangent : steepest_rise);
}

/// The depth that texels of a region must be nearer than to block a receiver of biased depth d: at most 2 % nearer, so
/// that wide regions do not lose the blockers that are close.
constexpr float most_rise = 0.02f;
PENUMBRA_HD inline float blocking_depth(float d, float rise, float width) {
  const float wanted = rise * width, most = most_rise * d;
  return d - (wanted < most ? wanted : most);
}

PENUMBRA_HD inline Projected project(const LightView& view, Bias bias, vec3 p, vec3 normal, bool touches) {
  const float z = view.depth(p);
  if (normal == vec3(0.0f) || !(z > 0.0f)) return {};
  const vec2 at = view.project(p, z);
  const float d = touches ? z - depth_bias(view, bias.texels, p, normal, z) : z;
  if (!(std::abs(at.x) < 1e6f && std::abs(at.y) < 1e6f && d > 0.0f)) return {};
  return {at.x, at.y, d, touches ? region_rise(view, bias.region, p, normal, z) : 0.0f};
}

/// Projects a tile's receivers one by one.
void project(const LightView& view, const Receivers& receivers, Bias bias, Tile& tile);

}  // namespace penumbra::shadow_map
