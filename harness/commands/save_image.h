// The image that a command was asked for.
#pragma once

#include <string>

#include "scenes/image.h"
#include "scenes/scene.h"

namespace penumbra {

/// Writes an image of a frame: .exr as it is, .png exposed for a display. Throws Error for any other name.
void save_image(const std::string& path, const Image& image, const Frame& frame);

}  // namespace penumbra
