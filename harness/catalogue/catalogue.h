// The one place that knows both techniques and devices.
#pragma once

#include "techniques/registry.h"

namespace penumbra {

/// Every technique on every backend of this build, and how its backends stand on this machine.
Registry make_registry();

}  // namespace penumbra
