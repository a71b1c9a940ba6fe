// The door between the registry and the CUDA backend.
#pragma once

#include <map>
#include <string>

namespace penumbra {

class Registry;

/// Adds an entry with the backend "cuda" for every technique that has kernels. Where they cannot run, because they are
/// not built or there is no device, Entry::unavailable says why.
void register_cuda(Registry& registry);

/// One line for listings: how CUDA stands in this build on this machine.
std::string cuda_status();

/// For the context of results: device, compute capability, driver, runtime, clocks, throttling. Empty without a device.
std::map<std::string, std::string> cuda_context();

}  // namespace penumbra
