// The simd backend of the family: the same steps with the kernels of kernel.h, tiles in parallel.
#pragma once

#include <functional>
#include <memory>

#include "techniques/pcss/soft_shadow.h"

namespace penumbra::pcss {

using Maker = std::function<std::unique_ptr<Technique>(const Parameters&)>;

Maker simd_hard_shadow();
Maker simd_rotated_shadow();
Maker simd_moment_shadow();
Maker simd_soft_shadow(SoftOptions (*options)(const Parameters&));

}  // namespace penumbra::pcss
