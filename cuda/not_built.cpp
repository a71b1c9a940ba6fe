// The CUDA backend where it is not built: techniques with kernels are known, and cannot run.
#include "cuda/kernels.h"
#include "cuda/register_cuda.h"

namespace penumbra {

void register_cuda(Registry& registry) {
  const std::string reason = "not built (configure with the preset cuda)";
  registry.set_state(Backend::cuda, {reason, {}});
  add_cuda_entries(registry, {}, reason);
}

}  // namespace penumbra
