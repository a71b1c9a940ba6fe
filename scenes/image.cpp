#include "scenes/image.h"

#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "scenes/error.h"

namespace penumbra {
namespace {

std::unique_ptr<OIIO::ImageInput> open(const std::string& path) {
  if (!std::filesystem::exists(path)) throw Error("{}: no such image file", path);
  auto input = OIIO::ImageInput::open(path);
  if (!input) throw Error("{}: cannot be read as an image ({})", path, OIIO::geterror());
  const OIIO::ImageSpec& spec = input->spec();
  if (spec.width <= 0 || spec.height <= 0 || spec.nchannels <= 0) throw Error("{}: the image is empty", path);
  return input;
}

void read_pixels(OIIO::ImageInput& input, const std::string& path, std::vector<float>& values) {
  const OIIO::ImageSpec& spec = input.spec();
  values.resize(std::size_t(spec.width) * spec.height * spec.nchannels);
  if (!input.read_image(0, 0, 0, spec.nchannels, OIIO::TypeDesc::FLOAT, values.data()))
    throw Error("{}: the image is damaged or cut short ({})", path, input.geterror());
}

void write(const std::string& path, const OIIO::ImageSpec& spec, const OIIO::TypeDesc& type, const void* data) {
  namespace fs = std::filesystem;
  const fs::path target(path);
  // The extension chooses the format, so it stays last.
  const fs::path partial = target.parent_path() / (".partial-" + target.filename().string());
  if (target.has_parent_path()) fs::create_directories(target.parent_path());
  auto output = OIIO::ImageOutput::create(partial.string());
  if (!output) throw Error("{}: no image format for this extension ({})", path, OIIO::geterror());
  if (!output->open(partial.string(), spec) || !output->write_image(type, data) || !output->close())
    throw Error("{}: cannot be written ({})", path, output->geterror());
  fs::rename(partial, target);
}

}  // namespace

float srgb_encode(float linear) {
  return linear <= 0.0031308f ? 12.92f * linear : 1.055f * std::pow(linear, 1.0f / 2.4f) - 0.055f;
}

Image load_image(const std::string& path) {
  const auto input = open(path);
  std::vector<float> values;
  read_pixels(*input, path, values);
  const int channels = input->spec().nchannels;
  Image image{input->spec().width, input->spec().height, {}};
  image.pixels.resize(std::size_t(image.width) * image.height);
  for (std::size_t i = 0; i < image.pixels.size(); ++i)
    for (int c = 0; c < 3; ++c) image.pixels[i][c] = values[i * channels + (channels < 3 ? 0 : c)];
  return image;
}

ChannelImage load_channels(const std::string& path) {
  const auto input = open(path);
  const OIIO::ImageSpec& spec = input->spec();
  ChannelImage image{spec.width, spec.height, {spec.channelnames.begin(), spec.channelnames.end()}, {}, {}};
  for (const auto& attribute : spec.extra_attribs)
    if (attribute.type() == OIIO::TypeDesc::STRING)
      image.attributes[attribute.name().string()] = attribute.get_string();
  read_pixels(*input, path, image.values);
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
