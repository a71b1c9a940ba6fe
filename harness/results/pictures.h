// Images for people: exposed, as signed error, side by side.
#pragma once

#include <functional>

#include "scenes/image.h"

namespace penumbra {

/// Calls `save`; what it throws becomes a warning: a full disk must not cost what has been measured.
void try_to_save(const std::function<void()>& save);

/// What save_png() has written, linear again. Throws Error if the file is missing or no such picture.
Image load_picture(const std::string& path);

Image exposed(const Image& image, double exposure);

/// Share of white at which a signed error has full colour.
inline constexpr double signed_error_range = 0.25;

/// Red where the image is too bright (leak), blue where it is too dark; full colour at a quarter of white.
Image signed_error(const Image& image, const Image& reference, double exposure);

/// At most so many pixels wide and high, for a sheet with labels: larger ones are averaged over squares of pixels, and
/// of smaller ones each pixel becomes a square.
Image panel(const Image& image, int widest);

/// Every step-th pixel, so that at most 128 are left in a row.
Image thumbnail(const Image& image);

/// Puts one image into another, its upper left corner at (x, y); what does not fit is cut off.
void paste(const Image& from, int x, int y, Image& to);

/// Equally large panels in rows, two pixels of white between, each as its thumbnail.
Image contact_sheet(const std::vector<std::vector<Image>>& rows);

}  // namespace penumbra
