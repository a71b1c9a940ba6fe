#include "cuda/register_cuda.h"

namespace penumbra {

void register_cuda(Registry&) {}
const char* cuda_status() {
  return "not built (configure with the preset cuda)";
}

}  // namespace penumbra
