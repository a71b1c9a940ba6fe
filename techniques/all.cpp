// The list of techniques: one line each, the name of its register function.
#include "techniques/all.h"

#define PENUMBRA_TECHNIQUES(USE) \
  USE(constant)                  \
  USE(ray_traced)                \
  USE(ray_traced_denoised)       \
  USE(pixel_basis)               \
  USE(wavelet)                   \
  USE(wavelet_product)           \
  USE(wavelet_dense)             \
  USE(sh_lighting)               \
  USE(sh_exponentiation)         \
  USE(shadow_map)                \
  USE(pcss)                      \
  USE(hqepcss)                   \
  USE(fast_pcss)                 \
  USE(pcss_rotated)              \
  USE(moment_shadows)            \
  USE(shadow_map_traced)         \
  USE(visibility_filter)         \
  USE(chen_2016)

namespace penumbra {

#define PENUMBRA_DECLARE(technique) void register_##technique(Registry& registry);
#define PENUMBRA_CALL(technique) register_##technique(registry);

PENUMBRA_TECHNIQUES(PENUMBRA_DECLARE)

void register_techniques(Registry& registry) {
  PENUMBRA_TECHNIQUES(PENUMBRA_CALL)
}

}  // namespace penumbra
