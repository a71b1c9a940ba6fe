// An environment as a picture that other programs can use.
#pragma once

#include "scenes/environment.h"

namespace penumbra {

/// Radiance over all world directions, W m^-2 sr^-1, the environment's rotation applied: texel (x, y), row 0 on top,
/// spans the longitudes left_edge - 2 pi [x, x + 1] / width and the latitudes pi / 2 - pi [y, y + 1] / height, and is
/// constant within; direction = (sin lon cos lat, sin lat, cos lon cos lat).
struct LatLongImage {
  Image image;
  double left_edge = pi;  ///< radians; differs from pi by at most half a texel, what is left of the rotation
  bool exact = true;      ///< false: resampled from a cube map
};

/// Latitude-longitude images are turned by whole texels, which changes none of them; cube maps of n x n texels a face
/// are resampled to 4n x 2n, 8 x 8 samples a texel.
LatLongImage as_lat_long(const Environment& environment);

}  // namespace penumbra
