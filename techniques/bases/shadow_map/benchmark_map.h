// What shadow-map techniques time their parts on.
#pragma once

#include <map>

#include "scenes/shapes.h"
#include "techniques/bases/shadow_map/shadow_map.h"

namespace penumbra::shadow_map {

/// The map of the scene soft-random.
inline const ShadowMap& map_of(int edge) {
  static std::map<int, ShadowMap> maps;
  const auto [at, fresh] = maps.try_emplace(edge);
  if (!fresh) return at->second;
  const Mesh mesh = make_primitives(7);
  const AreaLight lamp = make_rectangle({1, 5, -0.8f}, {0, 0, 1.2f}, {-1.164f, 0.292f, 0}, vec3(1.0f));
  const Receivers receivers = make_receivers({PlaneGrid{2.0f, 64, 0.0f}, vec3(1.0f)}, mesh);
  std::size_t outside = 0;
  LightViewSettings settings;
  settings.resolution = edge;
  at->second.view = make_light_view(lamp, mesh, receivers, settings, outside);
  trace(RayScene(mesh), at->second);
  return at->second;
}

}  // namespace penumbra::shadow_map
