#include "scenes/image.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "scenes/colour.h"
#include "scenes/error.h"
#include "scenes/image_input.h"
#include "scenes/storage/atomic_write.h"

namespace penumbra {
namespace {

void write(const std::string& path, const OIIO::ImageSpec& spec, const OIIO::TypeDesc& type, const void* data) {
  if (const std::filesystem::path target(path); target.has_parent_path()) make_folder(target.parent_path().string());
  write_atomically(path, [&](const std::string& temporary) {
    auto output = OIIO::ImageOutput::create(temporary);
    if (!output) throw Error("{}: no image format for this extension ({})", path, OIIO::geterror());
    if (!output->open(temporary, spec) || !output->write_image(type, data) || !output->close())
      throw Error("{}: cannot be written ({})", path, output->geterror());
  });
}

}  // namespace

ChannelImage load_channels(const std::string& path) {
  ImageInput input(path);
  const OIIO::ImageSpec& spec = input.spec();
  ChannelImage image{spec.width, spec.height, {spec.channelnames.begin(), spec.channelnames.end()}, {}, {}};
  for (const auto& attribute : spec.extra_attribs)
    if (attribute.type() == OIIO::TypeDesc::STRING)
      image.attributes[attribute.name().string()] = attribute.get_string();
  image.values = input.read(0, spec.nchannels);
  return image;
}

void save_channels(const std::string& path, const ChannelImage& image) {
  OIIO::ImageSpec spec(image.width, image.height, int(image.channels.size()), OIIO::TypeDesc::FLOAT);
  spec.channelnames.assign(image.channels.begin(), image.channels.end());
  for (const auto& [name, text] : image.attributes) spec.attribute(name, text);
  spec.attribute("compression", "zip");
  write(path, spec, OIIO::TypeDesc::FLOAT, image.values.data());
}

void save_exr(const std::string& path, const Image& image) {
  ChannelImage out{image.width, image.height, {"R", "G", "B"}, {}, {}};
  out.values.reserve(3 * image.pixels.size());
  for (const vec3& p : image.pixels) out.values.insert(out.values.end(), {p.x, p.y, p.z});
  save_channels(path, out);
}

void save_png(const std::string& path, const Image& image) {
  std::vector<unsigned char> bytes;
  bytes.reserve(3 * image.pixels.size());
  for (const vec3& p : image.pixels)
    for (int c = 0; c < 3; ++c) {
      const float v = p[c] > 0.0f ? std::min(p[c], 1.0f) : 0.0f;  // NaN becomes 0
      bytes.push_back(static_cast<unsigned char>(std::lround(srgb_encode(v) * 255.0f)));
    }
  write(path, OIIO::ImageSpec(image.width, image.height, 3, OIIO::TypeDesc::UINT8), OIIO::TypeDesc::UINT8,
        bytes.data());
}

}  // namespace penumbra
