// Where the first stored pixel of an image file lies.
#pragma once

#include "scenes/image.h"

namespace penumbra {

struct Orientation {
  bool columns = false;        ///< a stored row is a column of the picture
  bool right_to_left = false;  ///< the first stored pixel is on the right
  bool bottom_to_top = false;  ///< the first stored pixel is at the bottom
  bool operator==(const Orientation&) const = default;
};

/// The orientation that TIFF and Exif call by a number, 1 to 8; other numbers mean 1.
inline Orientation orientation_from_exif(int number) {
  if (number < 1 || number > 8) return {};
  const bool right = number == 2 || number == 3 || number == 6 || number == 7;
  const bool bottom = number == 3 || number == 4 || number == 7 || number == 8;
  return {number >= 5, right, bottom};
}

/// The picture upright: row 0 on top, column 0 on the left.
inline Image upright(Image stored, Orientation orientation) {
  if (orientation == Orientation{}) return stored;
  Image image = stored;
  if (orientation.columns) std::swap(image.width, image.height);
  for (int row = 0; row < stored.height; ++row)
    for (int i = 0; i < stored.width; ++i) {
      int x = orientation.columns ? row : i, y = orientation.columns ? i : row;
      if (orientation.right_to_left) x = image.width - 1 - x;
      if (orientation.bottom_to_top) y = image.height - 1 - y;
      image.pixels[std::size_t(y) * image.width + x] = stored.pixels[std::size_t(row) * stored.width + i];
    }
  return image;
}

}  // namespace penumbra
