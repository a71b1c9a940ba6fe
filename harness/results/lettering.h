// Text in pictures, with a font of this machine.
#pragma once

#include <string>
#include <vector>

#include "scenes/image.h"

namespace penumbra {

/// The text in the letters that can be drawn: ASCII, "+-" for a plus-minus sign, "..." for an ellipsis, "?" for others.
/// OpenImageIO 2.4 takes the last byte of a longer letter for the letter.
std::string drawable(const std::string& text);

/// Files and names of fonts that are common where penumbra runs, the best first.
std::vector<std::string> common_fonts();

class Lettering {
 public:
  /// Takes the first font that can be used.
  explicit Lettering(const std::vector<std::string>& fonts = common_fonts());
  /// Without a font (or an OpenImageIO without FreeType) texts have no width, and drawing does nothing.
  bool available() const { return !font_.empty(); }
  /// Width of a text in letters of `size` pixels, in pixels.
  int width(const std::string& text, int size) const;
  /// The text if it is at most `most` pixels wide, else as much of it as is, with an ellipsis behind it.
  std::string fitted(const std::string& text, int most, int size) const;
  /// The text broken at spaces into at most `lines` lines, each fitted.
  std::vector<std::string> wrapped(const std::string& text, int most, int size, std::size_t lines) const;
  /// Draws the text in black, from `x` on, letters standing on row `baseline`; what lies outside the image is cut off.
  void draw(const std::string& text, int x, int baseline, int size, Image& image) const;

 private:
  std::string font_;
};

}  // namespace penumbra
