#include "scenes/environment_image.h"

#include <tbb/parallel_for.h>

#include <cmath>

namespace penumbra {
namespace {

LatLongImage turned(const Environment& e) {
  LatLongImage out{{e.width, e.height, {}, Envmap::lat_long}};
  const long long texels = std::llround(e.rotation * e.width / (2.0 * pi));
  out.left_edge = pi + e.rotation - 2.0 * pi * double(texels) / e.width;
  const int first = int(((texels % e.width) + e.width) % e.width);
  out.image.pixels.reserve(e.radiance.size());
  for (int y = 0; y < e.height; ++y)
    for (int x = 0; x < e.width; ++x)
      out.image.pixels.push_back(e.radiance[std::size_t(y) * e.width + (x + first) % e.width]);
  return out;
}

LatLongImage resampled(const Environment& e) {
  constexpr int samples = 8;
  const LatLongMapping target{4 * e.width, 2 * e.width};
  LatLongImage out{{target.width, target.height, {}, Envmap::lat_long}, pi, false};
  out.image.pixels.resize(std::size_t(target.width) * target.height);
  const double c = std::cos(e.rotation), s = std::sin(e.rotation);
  tbb::parallel_for(0, target.height, [&](int y) {
    for (int x = 0; x < target.width; ++x) {
      dvec3 sum(0.0);
      for (int k = 0; k < samples * samples; ++k) {
        const int column = k % samples, row = k / samples;
        const dvec3 d = target.direction(x + (column + 0.5) / samples, y + (row + 0.5) / samples);
        const dvec3 stored(c * d.x - s * d.z, d.y, c * d.z + s * d.x);  // before the rotation
        sum += dvec3(e.radiance[std::size_t(e.cube().texel(stored))]);
      }
      out.image.pixels[std::size_t(y) * target.width + x] = vec3(sum / double(samples * samples));
    }
  });
  return out;
}

}  // namespace

LatLongImage as_lat_long(const Environment& environment) {
  return environment.mapping == Mapping::lat_long ? turned(environment) : resampled(environment);
}

}  // namespace penumbra
