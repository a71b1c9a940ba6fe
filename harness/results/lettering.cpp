#include "harness/results/lettering.h"

#include <OpenImageIO/imagebuf.h>
#include <OpenImageIO/imagebufalgo.h>

#include <algorithm>
#include <sstream>

#include "harness/results/text.h"

namespace penumbra {

std::string drawable(const std::string& text) {
  std::string out;
  for (std::string rest = text, letter; !rest.empty(); rest = rest.substr(letter.size())) {
    letter = first_letter(rest);
    if (letter.size() == 1 && static_cast<unsigned char>(letter[0]) < 0x80) out += letter;
    else out += letter == "±" ? "+-" : letter == "…" ? "..." : "?";
  }
  return out;
}

std::vector<std::string> common_fonts() {
  return {"/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf",
          "/usr/share/fonts/dejavu-sans-fonts/DejaVuSans.ttf",
          "/usr/share/fonts/truetype/liberation/LiberationSans-Regular.ttf",
          "DejaVuSans",
          "LiberationSans-Regular",
          "DroidSans",
          "Arial"};
}

Lettering::Lettering(const std::vector<std::string>& fonts) {
  const auto usable = [](const std::string& font) { return OIIO::ImageBufAlgo::text_size("x", 12, font).defined(); };
  const auto at = std::find_if(fonts.begin(), fonts.end(), usable);
  if (at != fonts.end()) font_ = *at;
  OIIO::geterror();  // of fonts that are not there
}

int Lettering::width(const std::string& text, int size) const {
  if (!available() || text.empty()) return 0;
  const OIIO::ROI box = OIIO::ImageBufAlgo::text_size(drawable(text), size, font_);
  return box.defined() ? std::max(0, box.xend) : 0;
}

std::string Lettering::fitted(const std::string& text, int most, int size) const {
  if (width(text, size) <= most) return text;
  std::string kept = text;
  do kept = without_last_letter(kept);
  while (!kept.empty() && width(kept + "…", size) > most);
  return kept.empty() ? "" : kept + "…";
}

std::vector<std::string> Lettering::wrapped(const std::string& text, int most, int size, std::size_t lines) const {
  std::vector<std::string> out;
  std::istringstream words(text);
  for (std::string word; words >> word;) {
    const bool joins = !out.empty() && (out.size() == lines || width(out.back() + " " + word, size) <= most);
    if (joins) out.back() += " " + word;
    else out.push_back(word);
  }
  for (std::string& line : out) line = fitted(line, most, size);
  return out;
}

void Lettering::draw(const std::string& text, int x, int baseline, int size, Image& image) const {
  if (!available() || text.empty()) return;
  static_assert(sizeof(vec3) == 3 * sizeof(float));
  const OIIO::ImageSpec spec(image.width, image.height, 3, OIIO::TypeDesc::FLOAT);
  OIIO::ImageBuf pixels(spec, image.pixels.data());
  OIIO::ImageBufAlgo::render_text(pixels, x, baseline, drawable(text), size, font_, {0.0f, 0.0f, 0.0f});
}

}  // namespace penumbra
