#include "harness/catalogue/catalogue.h"

#include "cuda/register_cuda.h"
#include "techniques/all.h"

namespace penumbra {

Registry make_registry() {
  Registry registry;
  register_techniques(registry);
  register_cuda(registry);
  return registry;
}

}  // namespace penumbra
