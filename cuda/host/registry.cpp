#include "cuda/host/registry.h"

#include "cuda/kernels.h"
#include "cuda/register_cuda.h"
#include "generated/kernel_list.h"
#include "techniques/all.h"

namespace penumbra::cuda_on_host {

PENUMBRA_KERNELS(PENUMBRA_DECLARE)

Registry make_registry() {
  Registry registry;
  register_techniques(registry);
  Registry with_device = registry;
  register_cuda(with_device);
  if (with_device.states().at(Backend::cuda).available()) return with_device;
  Makers makers;
  PENUMBRA_KERNELS(PENUMBRA_CALL)
  add_cuda_entries(registry, makers, "");
  return registry;
}

}  // namespace penumbra::cuda_on_host
