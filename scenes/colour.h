// Colour spaces of image files: primaries, luminance and chroma, transfer curves.
#pragma once

#include <string>

#include "scenes/math.h"

namespace penumbra {

/// CIE 1931 xy of red, green, blue and white.
struct Chromaticities {
  glm::dvec2 red, green, blue, white;
};

inline constexpr Chromaticities rec709{{0.64, 0.33}, {0.30, 0.60}, {0.15, 0.06}, {0.3127, 0.3290}};
/// The primaries of Radiance's RGB (Ward, "Radiance file formats"); white has equal energy.
inline constexpr Chromaticities radiance_primaries{{0.64, 0.33}, {0.29, 0.60}, {0.15, 0.06}, {1.0 / 3, 1.0 / 3}};

/// Chromaticities from eight numbers: x and y of red, green, blue and white.
Chromaticities chromaticities_from(const double (&xy)[8]);
std::string to_string(const Chromaticities& primaries);

/// Linear RGB to CIE XYZ, white with Y = 1 (SMPTE RP 177). Throws Error if the primaries span no colours.
glm::dmat3 xyz_from_rgb(const Chromaticities& primaries);

/// Linear RGB of one set of primaries to that of another; white stays white (Bradford adaptation, as in ICC profiles).
glm::dmat3 convert_primaries(const Chromaticities& from, const Chromaticities& to);

/// Does the conversion change nothing by more than 0.2 %? So it is with rounded digits, or the same primaries seen
/// under another white.
bool same_colours(const Chromaticities& a, const Chromaticities& b);

/// Shares of linear red, green and blue in luminance; they sum to 1.
dvec3 luminance_weights(const Chromaticities& primaries);

/// RGB of OpenEXR's luminance and chroma: RY = (R - Y) / Y, BY = (B - Y) / Y, Y with the weights above.
vec3 rgb_from_chroma(float y, float ry, float by, dvec3 weights);

float srgb_encode(float linear);   ///< IEC 61966-2-1
float srgb_decode(float encoded);  ///< IEC 61966-2-1

}  // namespace penumbra
