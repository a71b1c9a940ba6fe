#include "techniques/bases/ray_packets.h"

namespace penumbra {

void estimate_packet(const RayScene& rays, const Receivers& receivers, std::span<const int> which,
                     std::span<const LightSample* const> samples, int rays_per_receiver, vec3* radiance) {
  const int count = int(which.size());
  vec3 origin[RayPacket::size];
  dvec3 sum[RayPacket::size] = {};
  for (int i = 0; i < count; ++i) origin[i] = receivers.ray_origin(which[i]);

  struct Ray {
    int receiver, sample;
  };
  auto queue = make_ray_queue<Ray>(rays, [&](Ray ray, bool hit) {
    if (!hit) sum[ray.receiver] += dvec3(samples[ray.receiver][ray.sample].weight);
  });
  for (int j = 0; j < rays_per_receiver; ++j)
    for (int i = 0; i < count; ++i) {
      const LightSample& s = samples[i][j];
      if (s.weight != vec3(0.0f)) queue.push({i, j}, origin[i], s.direction, s.reach());
    }
  queue.flush();
  for (int i = 0; i < count; ++i) radiance[i] = vec3(sum[i] / double(rays_per_receiver));
}

}  // namespace penumbra
