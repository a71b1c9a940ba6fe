// The text in front of a Radiance picture's pixels (Ward, "Radiance file formats", 2.5): OpenImageIO decodes the
// pixels, but knows neither pictures in columns nor XYZ nor exposure.
#pragma once

#include <optional>

#include "scenes/colour.h"
#include "scenes/image_orientation.h"

namespace penumbra {

struct RadianceHeader {
  int width = 0, height = 0;  ///< of the stored rows
  Orientation orientation;
  bool xyz = false;            ///< CIE XYZ instead of RGB
  double exposure = 1.0;       ///< radiance was multiplied by it
  glm::dvec3 correction{1.0};  ///< and so was each channel, after the colours of `primaries`
  double gamma = 1.0;          ///< and the result raised to 1 / gamma (rgbe.c of Bruce Walter)
  std::optional<Chromaticities> primaries;
  std::size_t size = 0;  ///< bytes up to the first pixel
};

/// Do the bytes begin as Radiance's pictures do: with "#?", or with lines of text among which is their FORMAT?
bool is_radiance_picture(const std::string& bytes);

/// Reads the header. Throws Error that names `path` and the line which cannot be understood.
RadianceHeader read_radiance_header(const std::string& bytes, const std::string& path);

/// The picture's bytes with a header that says only how many pixels there are: what OpenImageIO reads.
std::string plain_radiance_picture(const RadianceHeader& header, const std::string& bytes);

}  // namespace penumbra
