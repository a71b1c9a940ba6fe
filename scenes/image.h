// Images on disk, through OpenImageIO.
#pragma once

#include <map>
#include <span>
#include <string>
#include <vector>

#include "scenes/math.h"

namespace penumbra {

/// How an image file says that it covers the sphere (OpenEXR's attribute "envmap").
enum class Envmap { unsaid, lat_long, cube };

/// Linear RGB, row 0 on top.
struct Image {
  int width = 0, height = 0;
  std::vector<vec3> pixels;
  Envmap envmap = Envmap::unsaid;
};

/// Several float channels with names and text attributes: what an EXR file holds.
struct ChannelImage {
  int width = 0, height = 0;
  std::vector<std::string> channels;
  std::vector<float> values;  ///< width * height * channels, channel fastest
  std::map<std::string, std::string> attributes;
};

/// A picture as its file means it: upright, exposure undone, channels found by name (grey is repeated), primaries of
/// Rec. 709, encoded values made linear, colours multiplied by alpha, the display window. `layer` chooses a layer or a
/// part of an OpenEXR file. What is applied is said in messages. Throws Error that names the file if it is missing,
/// damaged, or holds what is no picture.
Image load_image(const std::string& path, const std::string& layer = "");

/// All channels of a file as they are. Throws Error if the file is missing, truncated or not an image.
ChannelImage load_channels(const std::string& path);

/// Writes atomically, into a folder that is made if need be. Throws Error on failure.
void save_channels(const std::string& path, const ChannelImage& image);
void save_exr(const std::string& path, const Image& image);

/// Writes linear [0, 1] as 8-bit sRGB, values outside clipped; atomically, into a folder that is made if need be.
/// Throws Error on failure.
void save_png(const std::string& path, const Image& image);

}  // namespace penumbra
