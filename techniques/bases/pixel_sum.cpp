#include "techniques/bases/pixel_sum.h"

#include <limits>

namespace penumbra {

CubeLight::CubeLight(CubeMap<vec3> cube) : n(cube.n), radiance(std::move(cube.texels)) {
  for (int t = 0; t < 6 * n * n; ++t) {
    directions.push_back(cube_texel_direction(t, n));
    solid_angle.push_back(float(cube_texel_solid_angle(t, n)));
  }
}

CubeLight::CubeLight(const Environment& environment, int edge) : CubeLight(project(environment, edge)) {}

vec3 pixel_sum(const CubeLight& light, const BitCube& blocked, vec3 normal, vec3 albedo) {
  dvec3 sum(0.0);
  for (int t = 0; t < light.size(); ++t) {
    const float cosine = glm::dot(normal, light.directions[t]);
    if (cosine > 0.0f && !blocked.test(t)) sum += dvec3(light.radiance[t]) * double(light.solid_angle[t] * cosine);
  }
  return albedo * vec3(sum / pi);
}

void trace_texels(const RayScene& rays, vec3 position, vec3 normal, const std::vector<vec3>& directions, bool packets,
                  BitCube& blocked) {
  const vec3 origin = rays.lift(position, normal);
  int texels[RayScene::packet], waiting = 0;
  vec3 packet[RayScene::packet];
  const auto flush = [&] {
    const unsigned hits = waiting ? rays.occluded(waiting, origin, packet) : 0u;
    for (int i = 0; i < waiting; ++i)
      if (hits >> i & 1u) blocked.set(texels[i]);
    waiting = 0;
  };
  for (int t = 0; t < int(directions.size()); ++t) {
    if (glm::dot(normal, directions[t]) <= 0.0f) continue;
    if (!packets) {
      if (rays.occluded(origin, directions[t], std::numeric_limits<float>::infinity())) blocked.set(t);
      continue;
    }
    texels[waiting] = t;
    packet[waiting] = directions[t];
    if (++waiting == RayScene::packet) flush();
  }
  flush();
}

}  // namespace penumbra
