// Distant light: radiance over all directions, kept at the resolution and in the mapping it came in.
#pragma once

#include <string>
#include <vector>

#include "scenes/cube_map.h"
#include "scenes/image.h"

namespace penumbra {

/// How texels map to directions. Angular maps are converted to lat_long when loaded.
enum class Mapping { lat_long, cube };

/// Continuous texel coordinates (x to the right, y downward) <-> directions of a latitude-longitude image.
struct LatLongMapping {
  int width, height;
  dvec3 direction(double x, double y) const;
  double solid_angle(double x0, double x1, double y0, double y1) const;  ///< sr
  int texel(dvec3 direction) const;
};

/// Continuous texel coordinates <-> directions of a cube map stored as a column of six faces: y = face * n + row.
struct CubeMapping {
  int n;
  dvec3 direction(double x, double y) const;
  double solid_angle(double x0, double x1, double y0, double y1) const;  ///< sr
  int texel(dvec3 direction) const;
};

/// Piecewise constant radiance, W m^-2 sr^-1, one value per texel, row-major.
struct Environment {
  Mapping mapping = Mapping::lat_long;
  int width = 0, height = 0;  ///< a cube map is n x 6n
  std::vector<vec3> radiance;
  double rotation = 0.0;  ///< radians about +y, applied to the stored directions

  LatLongMapping lat_long() const { return {width, height}; }
  CubeMapping cube() const { return {width}; }
  double solid_angle(int texel) const;
  /// Unit world direction at (u, v) in [0, 1]^2 of a texel; equal areas of (u, v) are equal solid angles for
  /// lat_long and nearly so for cube, whose density `pdf` (per sr, within the texel) says exactly how nearly.
  vec3 direction(int texel, float u, float v, float* pdf = nullptr) const;
};

/// Radiance integrated over all directions, W m^-2.
dvec3 total_energy(const Environment& environment);

struct SanitizeCounts {
  std::size_t negative = 0, nan = 0, infinite = 0;
  explicit operator bool() const { return negative + nan + infinite > 0; }
};

/// NaN and negative channels become 0; +Inf becomes the largest finite value of the image (65504 if it has none).
SanitizeCounts sanitize(std::vector<vec3>& radiance);

/// Image layouts a file may have.
enum class Layout { automatic, lat_long, vertical_cross, horizontal_strip, angular };

/// Loads .exr, .hdr and whatever else OpenImageIO reads, as load_image does. `automatic` goes by what the file says,
/// and else by the proportions: 2:1 latitude-longitude, 3:4 vertical cross (-Z in the middle, seen from inside), 6:1
/// strip (+X -X +Y -Y +Z -Z with OpenGL's axes); square angular maps (Debevec 1998; centre -Z) must be named. Bad
/// texels are sanitised with a warning that counts them. Throws Error naming the file.
Environment load_environment(const std::string& path, Layout layout = Layout::automatic, const std::string& layer = "");

/// The environment that an image in memory shows, as load_environment() reads it; `what` names it in errors.
Environment environment_from_image(Image image, Layout layout, const std::string& what);

/// "constant" (radiance 1), "sun-sky", "lamps" (eight small lamps on a dim ambient), "softbox" (one
/// broad lobe on a dim ambient); false if unknown.
bool make_environment(const std::string& name, Environment& environment);
inline constexpr const char* environment_names = "constant, sun-sky, lamps, softbox";

/// Area-preserving projection onto 6 x n x n: every source texel's energy arrives exactly once (shares by
/// subdivision where it straddles target texels), rotation applied. Deterministic for any number of threads.
CubeMap<vec3> project(const Environment& environment, int n);

}  // namespace penumbra
