#include "scenes/colour.h"

#include <cmath>

#include "scenes/error.h"

namespace penumbra {
namespace {

glm::dvec3 xyz(glm::dvec2 c) {
  return {c.x, c.y, 1.0 - c.x - c.y};
}

/// Scales the responses of the eye's three kinds of cones (Lam 1985) from one white to another.
glm::dmat3 adaptation(glm::dvec3 from_white, glm::dvec3 to_white) {
  const glm::dmat3 cones =
      glm::transpose(glm::dmat3(0.8951, 0.2664, -0.1614, -0.7502, 1.7135, 0.0367, 0.0389, -0.0685, 1.0296));
  const glm::dvec3 gain = (cones * to_white) / (cones * from_white);
  return glm::inverse(cones) * glm::dmat3(gain.x, 0, 0, 0, gain.y, 0, 0, 0, gain.z) * cones;
}

glm::dvec3 white_of(const Chromaticities& primaries) {
  return xyz(primaries.white) / primaries.white.y;
}

}  // namespace

Chromaticities chromaticities_from(const double (&xy)[8]) {
  return {{xy[0], xy[1]}, {xy[2], xy[3]}, {xy[4], xy[5]}, {xy[6], xy[7]}};
}

std::string to_string(const Chromaticities& p) {
  return fmt::format("red {:.4g} {:.4g}, green {:.4g} {:.4g}, blue {:.4g} {:.4g}, white {:.4g} {:.4g}", p.red.x,
                     p.red.y, p.green.x, p.green.y, p.blue.x, p.blue.y, p.white.x, p.white.y);
}

glm::dmat3 xyz_from_rgb(const Chromaticities& p) {
  const glm::dmat3 directions(xyz(p.red), xyz(p.green), xyz(p.blue));
  // Negated, so that a NaN fails too.
  if (!(std::abs(glm::determinant(directions)) > 1e-6) || !(p.white.y > 1e-6))
    throw Error("the primaries ({}) span no colours", to_string(p));
  const glm::dvec3 scale = glm::inverse(directions) * white_of(p);
  return {directions[0] * scale.x, directions[1] * scale.y, directions[2] * scale.z};
}

glm::dmat3 convert_primaries(const Chromaticities& from, const Chromaticities& to) {
  return glm::inverse(xyz_from_rgb(to)) * adaptation(white_of(from), white_of(to)) * xyz_from_rgb(from);
}

bool same_colours(const Chromaticities& a, const Chromaticities& b) {
  const glm::dmat3 change = convert_primaries(a, b) - glm::dmat3(1.0);
  for (int column = 0; column < 3; ++column)
    for (int row = 0; row < 3; ++row)
      if (std::abs(change[column][row]) > 2e-3) return false;
  return true;
}

dvec3 luminance_weights(const Chromaticities& primaries) {
  const glm::dmat3 to_xyz = xyz_from_rgb(primaries);
  return {to_xyz[0].y, to_xyz[1].y, to_xyz[2].y};
}

vec3 rgb_from_chroma(float y, float ry, float by, dvec3 weights) {
  const double red = (double(ry) + 1.0) * y, blue = (double(by) + 1.0) * y;
  return vec3(red, (y - red * weights.x - blue * weights.z) / weights.y, blue);
}

float srgb_encode(float linear) {
  return linear <= 0.0031308f ? 12.92f * linear : 1.055f * std::pow(linear, 1.0f / 2.4f) - 0.055f;
}

float srgb_decode(float encoded) {
  return encoded <= 0.04045f ? encoded / 12.92f : std::pow((encoded + 0.055f) / 1.055f, 2.4f);
}

}  // namespace penumbra
