// Techniques whose kernels run on the host. For tests, and for counting what kernels do; never for timing.
#pragma once

#include "techniques/registry.h"

namespace penumbra::cuda_on_host {

/// All variants; those with the backend "cuda" are executed on the host unless a device can run them.
Registry make_registry();

}  // namespace penumbra::cuda_on_host
