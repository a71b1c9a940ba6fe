#include "scenes/environment.h"

#include <algorithm>
#include <cmath>

#include "scenes/error.h"
#include "scenes/log.h"
#include "scenes/projection.h"

namespace penumbra {

dvec3 LatLongMapping::direction(double x, double y) const {
  const double lon = pi - 2.0 * pi * x / width, lat = 0.5 * pi - pi * y / height;
  return {std::sin(lon) * std::cos(lat), std::sin(lat), std::cos(lon) * std::cos(lat)};
}

double LatLongMapping::solid_angle(double x0, double x1, double y0, double y1) const {
  const double lat0 = 0.5 * pi - pi * y0 / height, lat1 = 0.5 * pi - pi * y1 / height;
  return 2.0 * pi * (x1 - x0) / width * (std::sin(lat0) - std::sin(lat1));
}

int LatLongMapping::texel(dvec3 d) const {
  const double lon = std::atan2(d.x, d.z), lat = std::asin(std::clamp(d.y / glm::length(d), -1.0, 1.0));
  const int x = static_cast<int>((pi - lon) / (2.0 * pi) * width), y = static_cast<int>((0.5 * pi - lat) / pi * height);
  return std::clamp(y, 0, height - 1) * width + std::clamp(x, 0, width - 1);
}

dvec3 CubeMapping::direction(double x, double y) const {
  const int face = std::min(5, static_cast<int>(y / n));
  return glm::normalize(dvec3(cube_direction(face, float(2.0 * x / n - 1.0), float(2.0 * (y / n - face) - 1.0))));
}

double CubeMapping::solid_angle(double x0, double x1, double y0, double y1) const {
  const int face = static_cast<int>(0.5 * (y0 + y1) / n);
  const auto edge = [&](double c) { return 2.0 * c / n - 1.0; };
  return cube_solid_angle(edge(x0), edge(x1), edge(y0 - face * n), edge(y1 - face * n));
}

int CubeMapping::texel(dvec3 d) const {
  return cube_texel(vec3(d), n);
}

double Environment::solid_angle(int texel) const {
  const int x = texel % width, y = texel / width;
  return mapping == Mapping::lat_long ? lat_long().solid_angle(x, x + 1, y, y + 1)
                                      : cube().solid_angle(x, x + 1, y, y + 1);
}

vec3 Environment::direction(int texel, float u, float v, float* pdf) const {
  const int x = texel % width, y = texel / width;
  dvec3 d;
  if (mapping == Mapping::lat_long) {
    const double sin0 = std::cos(pi * y / height), sin1 = std::cos(pi * (y + 1) / height);
    const double sin_lat = sin0 + double(v) * (sin1 - sin0),
                 cos_lat = std::sqrt(std::max(0.0, 1.0 - sin_lat * sin_lat));
    const double lon = pi - 2.0 * pi * (x + double(u)) / width;
    d = {std::sin(lon) * cos_lat, sin_lat, std::cos(lon) * cos_lat};
    if (pdf) *pdf = static_cast<float>(1.0 / solid_angle(texel));
  } else {
    const int face = y / width;
    const double s = 2.0 * (x + double(u)) / width - 1.0, t = 2.0 * (y - face * width + double(v)) / width - 1.0;
    d = glm::normalize(dvec3(cube_direction(face, float(s), float(t))));
    if (pdf) *pdf = static_cast<float>(std::pow(1.0 + s * s + t * t, 1.5) * width * width / 4.0);
  }
  if (rotation == 0.0) return vec3(d);
  const double c = std::cos(rotation), s = std::sin(rotation);
  return vec3(dvec3(c * d.x + s * d.z, d.y, c * d.z - s * d.x));
}

dvec3 total_energy(const Environment& environment) {
  dvec3 sum(0.0);
  for (int i = 0; i < int(environment.radiance.size()); ++i)
    sum += dvec3(environment.radiance[i]) * environment.solid_angle(i);
  return sum;
}

SanitizeCounts sanitize(std::vector<vec3>& radiance) {
  SanitizeCounts counts;
  float cap = 0.0f;
  for (const vec3& texel : radiance)
    for (int c = 0; c < 3; ++c)
      if (std::isfinite(texel[c])) cap = std::max(cap, texel[c]);
  if (cap == 0.0f) cap = 65504.0f;  // the largest half-float
  for (vec3& texel : radiance)
    for (int c = 0; c < 3; ++c) {
      float& value = texel[c];
      if (std::isnan(value)) ++counts.nan, value = 0.0f;
      else if (value < 0.0f) ++counts.negative, value = 0.0f;
      else if (std::isinf(value)) ++counts.infinite, value = cap;
    }
  return counts;
}

namespace {

Layout layout_of(const Image& image, const std::string& what) {
  const int w = image.width, h = image.height;
  if (w == 2 * h) return Layout::lat_long;
  if (4 * w == 3 * h && w % 3 == 0) return Layout::vertical_cross;
  if (w == 6 * h) return Layout::horizontal_strip;
  throw Error(
      "{}: {} x {} is no known environment layout; latitude-longitude is 2:1, a vertical cross 3:4, a strip "
      "6:1, and a square angular map needs mapping = \"angular\"",
      what, w, h);
}

/// Faces of a vertical cross seen from inside, looking at -Z in its middle; `u` to the right and `v` downward in
/// [-1, 1] of each square of the cross.
///        +Y
///     -X -Z +X
///        -Y
///        +Z  (upside down)
vec3 cross_direction(int column, int row, float u, float v) {
  if (row == 0) return {u, 1, -v};
  if (row == 2) return {u, -1, v};
  if (row == 3) return {u, v, 1};
  if (column == 0) return {-1, -v, -u};
  if (column == 2) return {1, -v, u};
  return {u, -v, -1};
}

std::vector<vec3> faces_of_cross(const Image& image) {
  const int n = image.width / 3;
  CubeMap<vec3> cube(n);
  const int squares[6][2] = {{1, 0}, {0, 1}, {1, 1}, {2, 1}, {1, 2}, {1, 3}};
  for (const auto& [column, row] : squares)
    for (int y = 0; y < n; ++y)
      for (int x = 0; x < n; ++x)
        cube.texels[cube_texel(cross_direction(column, row, cube_centre(x, n), cube_centre(y, n)), n)] =
            image.pixels[std::size_t(row * n + y) * image.width + column * n + x];
  return cube.texels;
}

std::vector<vec3> faces_of_strip(const Image& image) {
  const int n = image.height;
  CubeMap<vec3> cube(n);
  for (int face = 0; face < 6; ++face)
    for (int y = 0; y < n; ++y)
      for (int x = 0; x < n; ++x)
        cube.texels[(face * n + y) * n + x] = image.pixels[std::size_t(y) * image.width + face * n + x];
  return cube.texels;
}

/// OpenEXR's cube maps (ImfEnvmap.h): a column of faces +X -X +Y -Y +Z -Z, each upright as seen from inside, the lower
/// ones as in a cross. OpenEXR puts the outer pixels' centres onto the cube's edges; here they are half a texel inside.
vec3 exr_cube_direction(int face, float u, float v) {
  constexpr int squares[4][2] = {{2, 1}, {0, 1}, {1, 0}, {1, 2}};
  if (face == 4) return {-u, -v, 1};
  return face == 5 ? cross_direction(1, 1, u, v) : cross_direction(squares[face][0], squares[face][1], u, v);
}

std::vector<vec3> faces_of_exr_cube(const Image& image) {
  const int n = image.width;
  CubeMap<vec3> cube(n);
  for (int t = 0; t < 6 * n * n; ++t)
    cube.texels[cube_texel(exr_cube_direction(t / (n * n), cube_centre(t % n, n), cube_centre(t / n % n, n)), n)] =
        image.pixels[t];
  return cube.texels;
}

/// Debevec's angular map: radius proportional to the angle from -Z.
struct AngularMapping {
  int size;
  dvec3 direction(double x, double y) const {
    const double u = 2.0 * x / size - 1.0, v = 1.0 - 2.0 * y / size, r = std::hypot(u, v);
    if (r == 0.0) return {0, 0, -1};
    const double sine = std::sin(pi * std::min(r, 1.0)) / r;
    return {u * sine, v * sine, -std::cos(pi * std::min(r, 1.0))};
  }
  /// Midpoint rule; exact in the limit of the subdivision that project_texels does at the rim.
  double solid_angle(double x0, double x1, double y0, double y1) const {
    const double u = (x0 + x1) / size - 1.0, v = 1.0 - (y0 + y1) / size, r = std::hypot(u, v);
    if (r >= 1.0) return 0.0;
    const double density = r < 1e-6 ? pi * pi : pi * std::sin(pi * r) / r;
    return density * 4.0 * (x1 - x0) * (y1 - y0) / size / size;
  }
};

Environment from_angular(const Image& image) {
  const int width = std::max(2, image.width / 2 * 2);
  Environment environment{Mapping::lat_long, width, width / 2, {}, 0.0};
  const auto target = environment.lat_long();
  const auto same = [](dvec3 d) { return d; };
  environment.radiance = project_texels(AngularMapping{image.width}, image.width, image.height, image.pixels, target,
                                        width * width / 2, same);
  for (int i = 0; i < int(environment.radiance.size()); ++i)
    environment.radiance[i] /= float(environment.solid_angle(i));
  return environment;
}

}  // namespace

Environment environment_from_image(Image image, Layout layout, const std::string& what) {
  if (image.pixels.empty()) throw Error("{}: the image is empty", what);
  if (const SanitizeCounts bad = sanitize(image.pixels))
    warn("{}: {} NaN and {} negative values set to 0, {} infinite ones capped", what, bad.nan, bad.negative,
         bad.infinite);
  const bool says_cube = layout == Layout::automatic && image.envmap == Envmap::cube;
  if (layout == Layout::automatic && image.envmap == Envmap::lat_long) layout = Layout::lat_long;
  if (layout == Layout::automatic && !says_cube) layout = layout_of(image, what);
  const int w = image.width, h = image.height;
  if (says_cube) {
    if (h != 6 * w) throw Error("{}: OpenEXR's cube maps are n x 6n, this is {} x {}", what, w, h);
    return {Mapping::cube, w, h, faces_of_exr_cube(image), 0.0};
  }
  switch (layout) {
    case Layout::vertical_cross:
      if (4 * w != 3 * h || w % 3) throw Error("{}: a vertical cross is 3n x 4n, this is {} x {}", what, w, h);
      return {Mapping::cube, w / 3, 2 * w, faces_of_cross(image), 0.0};
    case Layout::horizontal_strip:
      if (w != 6 * h) throw Error("{}: a strip is 6n x n, this is {} x {}", what, w, h);
      return {Mapping::cube, h, 6 * h, faces_of_strip(image), 0.0};
    case Layout::angular:
      if (w != h) throw Error("{}: an angular map is square, this is {} x {}", what, w, h);
      return from_angular(image);
    default:
      return {Mapping::lat_long, w, h, std::move(image.pixels), 0.0};
  }
}

Environment load_environment(const std::string& path, Layout layout, const std::string& layer) {
  return environment_from_image(load_image(path, layer), layout, path);
}

CubeMap<vec3> project(const Environment& environment, int n) {
  CubeMap<vec3> cube(n);
  if (environment.mapping == Mapping::lat_long) {
    cube.texels = project_lat_long(environment, n);
  } else {
    const double c = std::cos(environment.rotation), s = std::sin(environment.rotation);
    const bool turned = environment.rotation != 0.0;
    const auto rotate = [=](dvec3 d) { return turned ? dvec3(c * d.x + s * d.z, d.y, c * d.z - s * d.x) : d; };
    cube.texels = project_texels(environment.cube(), environment.width, environment.height, environment.radiance,
                                 CubeMapping{n}, 6 * n * n, rotate);
  }
  for (int i = 0; i < 6 * n * n; ++i) cube.texels[i] /= float(cube_texel_solid_angle(i, n));
  return cube;
}

namespace {

/// A blue gradient over brown ground, and a sun of half a degree radius.
vec3 sun_sky(vec3 d) {
  static const vec3 sun = glm::normalize(vec3(0.6f, 0.7f, 0.4f));
  const vec3 radiance =
      d.y >= 0 ? glm::mix(vec3(0.9f, 0.95f, 1.0f), vec3(0.15f, 0.35f, 0.9f), std::sqrt(d.y)) : vec3(0.12f, 0.1f, 0.08f);
  return glm::dot(d, sun) > std::cos(0.0087f) ? radiance + vec3(9000.0f, 8200.0f, 6800.0f) : radiance;
}

/// Eight coloured lamps of 2.3 degrees radius at different heights on a dim ambient.
vec3 lamps(vec3 d) {
  vec3 radiance(0.05f);
  for (int k = 0; k < 8; ++k) {
    const float lon = 0.4f + 0.785398f * float(k), lat = 0.35f + 0.12f * float(k * 3 % 8);
    const vec3 lamp(std::sin(lon) * std::cos(lat), std::sin(lat), std::cos(lon) * std::cos(lat));
    const vec3 colour(1.0f, 0.55f + 0.06f * float(k), 0.25f + 0.1f * float(7 - k));
    if (glm::dot(d, lamp) > std::cos(0.04f)) radiance += 60.0f * colour;
  }
  return radiance;
}

/// One broad lobe, cos^4, from 45 degrees above on a dim ambient: smooth, but with a side.
vec3 softbox(vec3 d) {
  static const vec3 towards = glm::normalize(vec3(1.0f, 1.4f, 1.0f));
  const float cosine = std::max(0.0f, glm::dot(d, towards));
  return vec3(0.2f) + vec3(3.0f, 2.8f, 2.5f) * (cosine * cosine * cosine * cosine);
}

}  // namespace

bool make_environment(const std::string& name, Environment& environment) {
  if (name == "constant") {  // a cube, whose texels fall exactly on those of coarser cubes
    environment = {Mapping::cube, 64, 384, std::vector<vec3>(6 * 64 * 64, vec3(1.0f)), 0.0};
    return true;
  }
  const auto radiance = name == "sun-sky" ? sun_sky : name == "lamps" ? lamps : name == "softbox" ? softbox : nullptr;
  if (!radiance) return false;
  environment = {Mapping::lat_long, 1024, 512, {}, 0.0};
  for (int y = 0; y < 512; ++y)
    for (int x = 0; x < 1024; ++x)
      environment.radiance.push_back(radiance(vec3(environment.lat_long().direction(x + 0.5, y + 0.5))));
  return true;
}

}  // namespace penumbra
