#include "cuda/register_cuda.h"

namespace penumbra {

void register_cuda(Registry&) {}
const char* cuda_status() {
  return "built, but no technique has a CUDA kernel yet";
}

}  // namespace penumbra
