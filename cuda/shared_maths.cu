// Compiles every PENUMBRA_HD function for the device, so that none stops being usable there unnoticed.
#include "scenes/cube_map.h"
#include "techniques/bases/cap.h"
#include "techniques/bases/random.h"

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

}  // namespace penumbra
