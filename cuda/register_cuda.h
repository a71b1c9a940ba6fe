// The door between the registry and the CUDA backend.
#pragma once

namespace penumbra {

class Registry;

/// Adds the backend "cuda" to every technique whose scalar entry has kernels, and tells the registry how CUDA stands.
/// Where kernels cannot run, because they are not built or there is no device, Entry::unavailable says why.
void register_cuda(Registry& registry);

}  // namespace penumbra
