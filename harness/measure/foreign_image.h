// Images that other programs made.
#pragma once

#include <string>

#include "scenes/image.h"
#include "scenes/receivers.h"

namespace penumbra {

/// Linear radiance of every receiver, W m^-2 sr^-1, from a file of floats (.exr, .pfm, .hdr, .tif); grey is repeated,
/// alpha is passed over. Invalid receivers become 0. Throws Error naming the file if it cannot be read, holds whole
/// numbers, has another size than `receivers` (of scene `scene`), or a valid receiver's radiance is not finite.
Image load_foreign_image(const std::string& path, const Receivers& receivers, const std::string& scene);

}  // namespace penumbra
