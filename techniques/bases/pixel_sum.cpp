#include "techniques/bases/pixel_sum.h"

#include <limits>

#include "techniques/bases/ray_packets.h"

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

void trace_texels(const RayScene& rays, vec3 origin, vec3 normal, const std::vector<vec3>& directions, bool packets,
                  BitCube& blocked) {
  constexpr float infinity = std::numeric_limits<float>::infinity();
  auto queue = make_ray_queue<int>(rays, [&](int texel, bool hit) {
    if (hit) blocked.set(texel);
  });
  for (int t = 0; t < int(directions.size()); ++t) {
    if (glm::dot(normal, directions[t]) <= 0.0f) continue;
    if (packets) queue.push(t, origin, directions[t], infinity);
    else if (rays.occluded(origin, directions[t], infinity)) blocked.set(t);
  }
  queue.flush();
}

}  // namespace penumbra
