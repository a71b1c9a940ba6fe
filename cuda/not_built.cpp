// The CUDA backend where it is not built: techniques with kernels are known, and cannot run.
#include "cuda/kernels.h"
#include "cuda/register_cuda.h"

namespace penumbra {

void register_cuda(Registry& registry) {
#define PENUMBRA_ADD(name, make) registry.add(cuda_entry(registry, name, nullptr, cuda_status()));
  PENUMBRA_CUDA_TECHNIQUES(PENUMBRA_ADD)
#undef PENUMBRA_ADD
}

std::string cuda_status() {
  return "not built (configure with the preset cuda)";
}

std::map<std::string, std::string> cuda_context() {
  return {};
}

}  // namespace penumbra
