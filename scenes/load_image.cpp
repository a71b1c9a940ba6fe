// Pictures as their files mean them. What a file says about its pixels is applied and said, or refused.

#include <algorithm>
#include <cmath>
#include <fstream>

#include "scenes/colour.h"
#include "scenes/error.h"
#include "scenes/image_input.h"
#include "scenes/image_layers.h"
#include "scenes/image_orientation.h"
#include "scenes/log.h"
#include "scenes/radiance_header.h"

namespace penumbra {
namespace {

void convert(std::vector<vec3>& pixels, const glm::dmat3& matrix) {
  for (vec3& p : pixels) p = vec3(matrix * dvec3(p));
}

void convert_to_rec709(std::vector<vec3>& pixels, const Chromaticities& primaries, const std::string& path) {
  convert(pixels, convert_primaries(primaries, rec709));
  inform("{}: the file's primaries ({}) are converted to those of Rec. 709", path, to_string(primaries));
}

// ---- Radiance pictures

/// The whole file, if it is a Radiance picture.
std::string radiance_bytes(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::string bytes(4096, '\0');
  file.read(bytes.data(), std::streamsize(bytes.size()));
  bytes.resize(std::size_t(std::max<std::streamsize>(0, file.gcount())));
  if (!is_radiance_picture(bytes)) return "";
  if (file) bytes.append(std::istreambuf_iterator<char>(file), {});
  return bytes;
}

std::vector<float> read_radiance_pixels(const RadianceHeader& header, const std::string& bytes,
                                        const std::string& path) {
  ImageInput input(path, plain_radiance_picture(header, bytes));
  try {
    return input.read(0, 3);
  } catch (const Error& e) {
    throw Error("{}; if it is whole, it has the run lengths of Radiance 1, which ra_rgbe makes new", e.what());
  }
}

/// From pixel values back to the radiance that they stand for; colours become those of Rec. 709.
void undo(const RadianceHeader& header, std::vector<vec3>& pixels, const std::string& path) {
  if (header.gamma != 1.0) {
    for (vec3& p : pixels) p = glm::pow(p, vec3(float(header.gamma)));
    warn("{}: GAMMA of the header is applied: pixel values are raised to {:.6g}", path, header.gamma);
  }
  if (header.xyz) {  // of no primaries; ra_xyze -r would make XYZ = 1 white instead of D65
    convert(pixels, glm::inverse(xyz_from_rgb(rec709)));
    inform("{}: CIE XYZ (XYZE) is converted to RGB of Rec. 709, whose white is D65", path);
  }
  if (header.exposure != 1.0)
    inform("{}: EXPOSURE of the header is undone: pixel values are divided by {:.6g}", path, header.exposure);
  if (const dvec3 c = header.correction; c != dvec3(1.0))
    inform("{}: COLORCORR of the header is undone: pixel values are divided by {:.6g} {:.6g} {:.6g}", path, c.x, c.y,
           c.z);
  const dvec3 divisor = header.exposure * header.correction;
  for (vec3& p : pixels) p = vec3(dvec3(p) / divisor);
  // Radiance's own primaries are taken for Rec. 709's, as everyone does.
  const Chromaticities primaries = header.primaries.value_or(rec709);
  if (!header.xyz && !same_colours(primaries, radiance_primaries) && !same_colours(primaries, rec709))
    convert_to_rec709(pixels, primaries, path);
}

Image load_radiance(const std::string& bytes, const std::string& path) {
  const RadianceHeader header = read_radiance_header(bytes, path);
  const std::vector<float> values = read_radiance_pixels(header, bytes, path);
  Image stored{header.width, header.height, std::vector<vec3>(values.size() / 3)};
  for (std::size_t i = 0; i < stored.pixels.size(); ++i)
    stored.pixels[i] = {values[3 * i], values[3 * i + 1], values[3 * i + 2]};
  undo(header, stored.pixels, path);
  if (header.orientation != Orientation{}) inform("{}: set upright as its resolution line says", path);
  return upright(std::move(stored), header.orientation);
}

// ---- All others

/// Positions on `input` at the layer's part.
Layer find_layer(ImageInput& input, const std::string& wanted, const std::string& path) {
  const auto names = [&] {
    return std::vector<std::string>(input.spec().channelnames.begin(), input.spec().channelnames.end());
  };
  if (input.is_exr()) {
    std::vector<Layer> layers;
    for (int part = 0; input.seek(part); ++part) {
      const std::string name = input.spec().get_string_attribute("oiio:subimagename");
      for (Layer& layer : find_layers(part, name, names())) layers.push_back(std::move(layer));
    }
    Layer layer = choose_layer(layers, wanted, path);
    if (wanted.empty() && !layer.name.empty()) inform("{}: layer '{}' is used", path, layer.address());
    input.seek(layer.part);
    return layer;
  }
  if (!wanted.empty()) throw Error("{}: only OpenEXR images have layers; leave 'layer' out", path);
  if (input.seek(1)) warn("{}: the first of several images in this file is used", path);
  input.seek(0);
  if (input.spec().nchannels == 1) return {0, "", "", Layer::Kind::grey, {0, 0, 0}, -1};
  return choose_layer(find_layers(0, "", names()), "", path);
}

void refuse_what_is_no_picture(const ImageInput& input, const Layer& layer, const std::string& path) {
  const OIIO::ImageSpec& spec = input.spec();
  if (spec.deep) throw Error("{}: is a deep image (many samples in a pixel); flatten it first", path);
  if (spec.depth > 1) throw Error("{}: is a volume of {} slices, not an image", path, spec.depth);
  for (const int c : layer.channels)
    if (input.is_exr() && spec.channelformat(c) == OIIO::TypeDesc::UINT)
      throw Error("{}: channel {} holds whole numbers (uint), such as ids, not radiance", path, spec.channel_name(c));
}

struct Pixels {
  std::vector<vec3> colours;
  std::vector<float> alpha;  ///< empty if there is none
};

Pixels read_layer(ImageInput& input, const Layer& layer) {
  int first = layer.channels[0], last = first;
  for (const int c : {layer.channels[1], layer.channels[2], layer.alpha < 0 ? first : layer.alpha})
    first = std::min(first, c), last = std::max(last, c);
  const std::vector<float> values = input.read(first, last + 1);
  const std::size_t stride = std::size_t(last - first) + 1, count = values.size() / stride;
  Pixels pixels{std::vector<vec3>(count), std::vector<float>(layer.alpha < 0 ? 0 : count)};
  for (std::size_t i = 0; i < count; ++i) {
    for (int c = 0; c < 3; ++c) pixels.colours[i][c] = values[i * stride + std::size_t(layer.channels[c] - first)];
    if (layer.alpha >= 0) pixels.alpha[i] = values[i * stride + std::size_t(layer.alpha - first)];
  }
  return pixels;
}

/// Images of whole numbers are encoded for screens, unless they say that they are not; those of floats are linear.
void make_linear(std::vector<vec3>& pixels, const OIIO::ImageSpec& spec, const std::string& path) {
  const bool integers = !spec.format.is_floating_point();
  std::string space = spec.get_string_attribute("oiio:ColorSpace", integers ? "sRGB" : "Linear");
  std::transform(space.begin(), space.end(), space.begin(), [](unsigned char c) { return char(std::tolower(c)); });
  std::string curve = "linear";
  if (space == "rec709" && !integers) space = "linear";  // a portable float map
  if (space == "srgb" || space == "rec709") {  // PNM's: written for sRGB screens in spite of its specification
    for (vec3& p : pixels) p = {srgb_decode(p.x), srgb_decode(p.y), srgb_decode(p.z)};
    curve = "sRGB, made linear";
  } else if (space.starts_with("gamma")) {
    const float gamma = spec.get_float_attribute("oiio:Gamma");
    if (!(gamma > 0.0f)) throw Error("{}: its gamma is {}, which must be positive", path, gamma);
    for (vec3& p : pixels) p = glm::pow(p, vec3(gamma));
    curve = fmt::format("gamma {:.4g}, made linear", gamma);
  } else if (space != "linear") {
    throw Error("{}: its colour space '{}' is not known; save it as sRGB or linear", path, space);
  }
  if (!integers && space == "linear") return;
  const std::string profile = spec.get_string_attribute("ICCProfile:profile_description");
  warn("{}: an image of low dynamic range ({}) is used as light: what was brighter than its white is lost{}", path,
       curve, profile.empty() ? "" : "; its colour profile '" + profile + "' is not applied");
}

void apply_alpha(Pixels& pixels, const OIIO::ImageSpec& spec, const std::string& path) {
  const auto transparent = std::count_if(pixels.alpha.begin(), pixels.alpha.end(), [](float a) { return a < 1.0f; });
  if (transparent == 0) return;
  const auto clear = std::count(pixels.alpha.begin(), pixels.alpha.end(), 0.0f);
  const bool separate = spec.get_int_attribute("oiio:UnassociatedAlpha") != 0;
  if (separate)
    for (std::size_t i = 0; i < pixels.alpha.size(); ++i) pixels.colours[i] *= pixels.alpha[i];
  warn("{}: {} of {} pixels are transparent, {} of them wholly; {} multiplied by alpha", path, transparent,
       pixels.alpha.size(), clear, separate ? "their colours are" : "colours are used as stored,");
}

void convert_colours(std::vector<vec3>& pixels, const OIIO::ImageSpec& spec, const Layer& layer,
                     const std::string& path) {
  Chromaticities primaries = rec709;
  float xy[8];
  if (spec.getattribute("chromaticities", OIIO::TypeDesc(OIIO::TypeDesc::FLOAT, 8), xy))
    primaries = {{xy[0], xy[1]}, {xy[2], xy[3]}, {xy[4], xy[5]}, {xy[6], xy[7]}};
  if (layer.kind == Layer::Kind::chroma) {
    const dvec3 weights = luminance_weights(primaries);
    for (vec3& p : pixels) p = rgb_from_chroma(p.x, p.y, p.z, weights);
    inform("{}: luminance and chroma (Y, RY, BY) are converted to RGB", path);
  }
  if (layer.kind != Layer::Kind::grey && !same_colours(primaries, rec709)) convert_to_rec709(pixels, primaries, path);
}

/// What lies outside of the display window is cut off, what the file does not hold of it is black.
Image in_display_window(Image data, const ImageInput& input, const std::string& path) {
  const OIIO::ImageSpec& spec = input.spec();
  const bool resized = spec.full_width != spec.width || spec.full_height != spec.height;
  // PNG's and TIFF's offsets are places on a page; a display window tells from its size.
  if (!resized && !(input.is_exr() && (spec.full_x != spec.x || spec.full_y != spec.y))) return data;
  input.check_size(spec.full_width, spec.full_height);
  const long long dx = (long long)(spec.full_x) - spec.x, dy = (long long)(spec.full_y) - spec.y;
  Image shown{spec.full_width, spec.full_height, {}};
  shown.pixels.resize(std::size_t(shown.width) * shown.height, vec3(0.0f));
  std::size_t kept = 0;
  for (int y = 0; y < shown.height; ++y)
    for (int x = 0; x < shown.width; ++x)
      if (x + dx >= 0 && x + dx < data.width && y + dy >= 0 && y + dy < data.height) {
        shown.pixels[std::size_t(y) * shown.width + x] = data.pixels[std::size_t(y + dy) * data.width + (x + dx)];
        ++kept;
      }
  const std::string said = fmt::format(
      "{}: the display window is {} x {} pixels: {} that the file does not hold are black, {} outside are cut off",
      path, shown.width, shown.height, shown.pixels.size() - kept, data.pixels.size() - kept);
  kept < shown.pixels.size() ? log_warning(said) : log_information(said);
  return shown;
}

Envmap envmap_of(const OIIO::ImageSpec& spec) {
  const std::string said = spec.get_string_attribute("textureformat");
  return said == "LatLong Environment"    ? Envmap::lat_long
         : said == "CubeFace Environment" ? Envmap::cube
                                          : Envmap::unsaid;
}

}  // namespace

Image load_image(const std::string& path, const std::string& layer) {
  const std::string radiance = radiance_bytes(path);
  if (!radiance.empty()) {
    if (!layer.empty()) throw Error("{}: only OpenEXR images have layers; leave 'layer' out", path);
    return load_radiance(radiance, path);
  }
  ImageInput input(path);
  const Layer chosen = find_layer(input, layer, path);
  const OIIO::ImageSpec& spec = input.spec();
  refuse_what_is_no_picture(input, chosen, path);
  Pixels pixels = read_layer(input, chosen);
  make_linear(pixels.colours, spec, path);
  apply_alpha(pixels, spec, path);
  convert_colours(pixels.colours, spec, chosen, path);
  Image image = in_display_window({spec.width, spec.height, std::move(pixels.colours), envmap_of(spec)}, input, path);
  const Orientation orientation = orientation_from_exif(spec.get_int_attribute("Orientation", 1));
  if (orientation != Orientation{}) inform("{}: set upright as its orientation tag says", path);
  return upright(std::move(image), orientation);
}

}  // namespace penumbra
