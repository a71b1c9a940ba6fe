#include "cuda/host/registry.h"

#include "cuda/kernels.h"

namespace penumbra::cuda_on_host {

Registry make_registry() {
  Registry registry;
  const Registry all = penumbra::make_registry();
  for (const Entry& entry : all.entries())
    if (entry.backend != "cuda" || entry.unavailable.empty()) registry.add(entry);
  const auto add = [&](const char* name, Maker make) {
    if (!all.find(name, "cuda").unavailable.empty()) registry.add(cuda_entry(registry, name, std::move(make), ""));
  };
#define PENUMBRA_ADD(name, make) add(name, make);
  PENUMBRA_CUDA_TECHNIQUES(PENUMBRA_ADD)
#undef PENUMBRA_ADD
  return registry;
}

}  // namespace penumbra::cuda_on_host
