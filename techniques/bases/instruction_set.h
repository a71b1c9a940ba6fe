// The instruction set that vectorised kernels run on.
#pragma once

#include <hwy/targets.h>

#include <string>

namespace penumbra {

/// The best one that this processor has and kernels were compiled for, e.g. "AVX3": what dynamic dispatch chooses.
inline std::string instruction_set_of_kernels() {
  const std::int64_t usable = hwy::SupportedTargets() & HWY_TARGETS;
  return hwy::TargetName(usable & -usable);
}

}  // namespace penumbra
