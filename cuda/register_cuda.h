// The door between the registry and the CUDA backend.
#pragma once

namespace penumbra {

class Registry;

/// Adds the CUDA variants; a build without CUDA links a version that adds nothing.
void register_cuda(Registry& registry);

/// One line for listings: how CUDA stands in this build on this machine.
const char* cuda_status();

}  // namespace penumbra
