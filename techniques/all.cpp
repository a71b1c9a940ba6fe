// One line per technique.
#include "cuda/register_cuda.h"
#include "techniques/pcss/pcss.h"
#include "techniques/pixel_basis/pixel_basis.h"
#include "techniques/ray_traced/ray_traced.h"
#include "techniques/registry.h"
#include "techniques/sh_exponentiation/sh_exponentiation.h"
#include "techniques/sh_lighting/sh_lighting.h"
#include "techniques/wavelet/wavelet.h"

namespace penumbra {

Registry make_registry() {
  Registry registry;
  register_ray_traced(registry);
  register_pixel_basis(registry);
  register_wavelet(registry);
  register_sh_lighting(registry);
  register_sh_exponentiation(registry);
  register_pcss(registry);
  register_cuda(registry);
  return registry;
}

}  // namespace penumbra
