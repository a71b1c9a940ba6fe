// Integration in the pixel basis over binary visibility (algorithm of the ground truth in Zhao & Che 2011).
#pragma once

namespace penumbra {

class Registry;
void register_pixel_basis(Registry& registry);

}  // namespace penumbra
