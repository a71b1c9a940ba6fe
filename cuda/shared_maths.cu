// Compiles every PENUMBRA_HD function for the device, so that none stops being usable there unnoticed.
#include "scenes/cube_map.h"
#include "techniques/bases/area_irradiance.h"
#include "techniques/bases/cap.h"
#include "techniques/bases/random.h"
#include "techniques/moment_shadows/moments.h"
#include "techniques/pcss/reuse.h"
#include "techniques/pcss_rotated/pcss_rotated.h"

namespace penumbra {

/// One texel a thread: is its centre covered by the sphere, and a random number of its own.
__global__ void cover_texels(vec3 centre, float radius, vec3 x, int n, unsigned char* blocked, float* noise) {
  const int t = int(blockIdx.x * blockDim.x + threadIdx.x);
  if (t >= 6 * n * n) return;
  const vec3 direction = cube_texel_direction(t, n);
  blocked[t] = covers(make_cap(centre, radius, x), direction) && cube_texel(direction, n) == t;
  vec3 tangent, bitangent;
  orthonormal_frame(direction, tangent, bitangent);
  noise[t] = random_triple(mix_bits(std::uint64_t(t)), 0).x * luminance(tangent + bitangent);
}

/// One receiver a thread: unshadowed light, region, square, links and moments of the shadow-map family.
__global__ void shadow_map_maths(LampOutline lamp, shadow_map::LightView view, pcss::Reuse reuse,
                                 shadow_map::Snapping how, vec3 p, vec3 n, moment_shadows::Moments b, float* out,
                                 shadow_map::Square* square) {
  const float z = view.depth(p), biased = z - shadow_map::depth_bias(view, 1.0f, p, n, z);
  const float width = view.region(view.near, biased);
  const float d = shadow_map::blocking_depth(biased, shadow_map::region_rise(view, 1.0f, p, n, z), width);
  const vec2 at = view.project(p, z);
  *square = shadow_map::snap(at.x, at.y, width, view.resolution, 10, how);
  const pcss::RegionKey key{at.x, at.y, width, d};
  const vec2 turned = pcss_rotated::placed(pcss_rotated::Pattern::vogel, at, pcss_rotated::gradient_noise(3, 4), 0.0f);
  *out = form_factor(lamp, p, n) + float(shadow_map::texels_of(at.x, at.y, width).count()) +
         float(pcss::alike(key, key, reuse)) +
         float(moment_shadows::blockers_of_moments(moment_shadows::biased(b, 1e-7), d).share) + turned.x;
}

}  // namespace penumbra
