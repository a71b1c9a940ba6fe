// Portable float maps: images of floats that ten lines of any language read and write.
#pragma once

#include <string>

#include "scenes/image.h"

namespace penumbra {

/// A header of three lines ("PF", width and height, -1.0 for little-endian), then the floats of R, G and B, lowest row
/// first. Written atomically. Throws Error if it cannot be written. load_image() reads it.
void save_pfm(const std::string& path, const Image& image);

}  // namespace penumbra
