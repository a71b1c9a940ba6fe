#include "cuda/kernels.h"

#include <stdexcept>

namespace penumbra {

void add_cuda_entries(Registry& registry, const Makers& makers, const std::string& unavailable) {
  std::size_t used = 0;
  for (Entry entry : std::vector<Entry>(registry.entries())) {
    if (!entry.kernels) continue;
    const auto maker = makers.find(entry.name);
    if (maker != makers.end()) entry.make = maker->second, ++used;
    else if (!makers.empty()) throw std::logic_error(entry.name + " has kernels by its entry, but no file adds them");
    const std::vector<Parameter>& more = entry.kernels->parameters;
    entry.parameters.insert(entry.parameters.end(), more.begin(), more.end());
    entry.backend = Backend::cuda, entry.unavailable = unavailable;
    registry.add(std::move(entry));
  }
  if (used != makers.size()) throw std::logic_error("a file of kernels adds a technique whose entry has none");
}

}  // namespace penumbra
