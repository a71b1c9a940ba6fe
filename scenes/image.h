// Images on disk, through OpenImageIO.
#pragma once

#include <map>
#include <span>
#include <string>
#include <vector>

#include "scenes/math.h"

namespace penumbra {

/// Linear RGB, row 0 on top.
struct Image {
  int width = 0, height = 0;
  std::vector<vec3> pixels;
};

/// Several float channels with names and text attributes: what an EXR file holds.
struct ChannelImage {
  int width = 0, height = 0;
  std::vector<std::string> channels;
  std::vector<float> values;  ///< width * height * channels, channel fastest
  std::map<std::string, std::string> attributes;
};

/// First three channels (grey is repeated) as float. Throws Error if missing, unreadable, or of zero size.
Image load_image(const std::string& path);

/// Throws Error if the file is missing, truncated or not an image.
ChannelImage load_channels(const std::string& path);

/// Writes beside the target and renames, so that a reader never sees half a file. Throws Error on failure.
void save_channels(const std::string& path, const ChannelImage& image);
void save_exr(const std::string& path, const Image& image);

/// 8-bit sRGB from linear [0, 1]; values outside are clipped. Atomic as above.
void save_png(const std::string& path, const Image& image);

float srgb_encode(float linear);  ///< IEC 61966-2-1

}  // namespace penumbra
