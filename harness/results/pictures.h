// Images for people: exposed, as signed error, side by side.
#pragma once

#include <functional>

#include "scenes/image.h"

namespace penumbra {

/// Calls `save`; what it throws becomes a warning: a full disk must not cost what has been measured.
void try_to_save(const std::function<void()>& save);

Image exposed(const Image& image, double exposure);

/// Red where the image is too bright (leak), blue where it is too dark; full colour at a quarter of white.
Image signed_error(const Image& image, const Image& reference, double exposure);

/// Every step-th pixel, so that at most 128 are left in a row.
Image thumbnail(const Image& image);

/// Equally large panels in rows, two pixels of white between, each as its thumbnail.
Image contact_sheet(const std::vector<std::vector<Image>>& rows);

}  // namespace penumbra
