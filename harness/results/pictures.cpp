#include "harness/results/pictures.h"

#include <algorithm>
#include <cmath>

#include "scenes/colour.h"
#include "scenes/error.h"
#include "scenes/log.h"

namespace penumbra {

void try_to_save(const std::function<void()>& save) {
  try {
    save();
  } catch (const std::exception& e) {
    warn("{}; going on without", e.what());
  }
}

Image load_picture(const std::string& path) {
  const ChannelImage file = load_channels(path);
  if (file.channels.size() != 3) throw Error("{}: {} channels; a picture has 3", path, file.channels.size());
  Image image{file.width, file.height, {}};
  for (std::size_t i = 0; i < file.values.size(); i += 3)
    image.pixels.emplace_back(srgb_decode(file.values[i]), srgb_decode(file.values[i + 1]),
                              srgb_decode(file.values[i + 2]));
  return image;
}

Image exposed(const Image& image, double exposure) {
  Image out = image;
  for (vec3& p : out.pixels) p = vec3(dvec3(p) * exposure);
  return out;
}

Image signed_error(const Image& image, const Image& reference, double exposure) {
  Image out{image.width, image.height, {}};
  for (std::size_t i = 0; i < image.pixels.size(); ++i) {
    const double e = std::clamp(
        exposure / signed_error_range * double(luminance(image.pixels[i]) - luminance(reference.pixels[i])), -1.0, 1.0);
    const auto fade = float(1.0 - std::abs(e));
    out.pixels.push_back(e >= 0 ? vec3(1.0f, fade, fade) : vec3(fade, fade, 1.0f));
  }
  return out;
}

namespace {

Image averaged(const Image& image, int step) {
  Image out{(image.width + step - 1) / step, (image.height + step - 1) / step, {}};
  for (int y = 0; y < image.height; y += step)
    for (int x = 0; x < image.width; x += step) {
      vec3 sum(0.0f);
      int count = 0;
      for (int v = y; v < std::min(y + step, image.height); ++v)
        for (int u = x; u < std::min(x + step, image.width); ++u, ++count)
          sum += image.pixels[std::size_t(v) * image.width + u];
      out.pixels.push_back(sum / float(count));
    }
  return out;
}

Image repeated(const Image& image, int times) {
  Image out{image.width * times, image.height * times, {}};
  for (int y = 0; y < out.height; ++y)
    for (int x = 0; x < out.width; ++x)
      out.pixels.push_back(image.pixels[std::size_t(y / times) * image.width + x / times]);
  return out;
}

}  // namespace

Image panel(const Image& image, int widest) {
  const int size = std::max({1, image.width, image.height});
  return size > widest ? averaged(image, (size + widest - 1) / widest) : repeated(image, widest / size);
}

Image thumbnail(const Image& image) {
  constexpr int widest = 128;
  const int step = std::max(1, (image.width + widest - 1) / widest);
  Image small{(image.width + step - 1) / step, (image.height + step - 1) / step, {}};
  for (int y = 0; y < image.height; y += step)
    for (int x = 0; x < image.width; x += step) small.pixels.push_back(image.pixels[std::size_t(y) * image.width + x]);
  return small;
}

void paste(const Image& from, int x, int y, Image& to) {
  const int rows = std::min(from.height, to.height - y), columns = std::min(from.width, to.width - x);
  for (int row = 0; row < rows; ++row)
    std::copy_n(from.pixels.begin() + std::ptrdiff_t(row) * from.width, columns,
                to.pixels.begin() + std::ptrdiff_t(y + row) * to.width + x);
}

Image contact_sheet(const std::vector<std::vector<Image>>& rows) {
  if (rows.empty() || rows[0].empty()) return {};
  constexpr int gap = 2;
  const Image first = thumbnail(rows[0][0]);
  const int width = first.width, height = first.height;
  Image sheet{int(rows[0].size()) * (width + gap) - gap, int(rows.size()) * (height + gap) - gap, {}};
  sheet.pixels.assign(std::size_t(sheet.width) * sheet.height, vec3(1.0f));
  for (std::size_t r = 0; r < rows.size(); ++r)
    for (std::size_t c = 0; c < rows[r].size(); ++c)
      paste(thumbnail(rows[r][c]), int(c) * (width + gap), int(r) * (height + gap), sheet);
  return sheet;
}

}  // namespace penumbra
