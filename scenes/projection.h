// Area-preserving transfer of texel energy from one mapping of the sphere to another.
#pragma once

#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <vector>

#include "scenes/math.h"

namespace penumbra {

/// Energy (value * solid angle) per texel of `target`, W m^-2 for radiance. A source cell that falls into one target
/// texel is handed over whole; one that straddles a border is split in four, `depth` times at most, so that the shares
/// are right to 2^-depth of a source texel and the sum is exact. Source needs direction() and solid_angle() of
/// continuous texel coordinates, Target needs texel(direction); `rotate` turns source into target directions.
template <class Source, class Target, class Rotate>
class TexelProjector {
 public:
  TexelProjector(const Source& source, const Target& target, int target_texels, const Rotate& rotate)
      : source_(source), target_(target), rotate_(rotate), largest_(2.0 * pi / target_texels) {}

  void add(dvec3 value, double x, double y, std::vector<dvec3>& energy) const {
    split(value, x, x + 1.0, y, y + 1.0, 0, energy);
  }

 private:
  static constexpr int depth = 6;

  int texel(double x, double y) const { return target_.texel(rotate_(source_.direction(x, y))); }

  void split(dvec3 value, double x0, double x1, double y0, double y1, int level, std::vector<dvec3>& energy) const {
    const double area = source_.solid_angle(x0, x1, y0, y1);
    const double xc = 0.5 * (x0 + x1), yc = 0.5 * (y0 + y1);
    // Corners a little inside, so that borders which coincide do not look like straddling.
    const double ex = 1e-3 * (x1 - x0), ey = 1e-3 * (y1 - y0);
    const bool small = area < largest_;
    const int first = texel(x0 + ex, y0 + ey);
    if (small && (level >= depth || (first == texel(x1 - ex, y0 + ey) && first == texel(x0 + ex, y1 - ey) &&
                                     first == texel(x1 - ex, y1 - ey)))) {
      energy[level >= depth ? texel(xc, yc) : first] += value * area;
      return;
    }
    const int next = small ? level + 1 : 0;
    split(value, x0, xc, y0, yc, next, energy);
    split(value, xc, x1, y0, yc, next, energy);
    split(value, x0, xc, yc, y1, next, energy);
    split(value, xc, x1, yc, y1, next, energy);
  }

  const Source& source_;
  const Target& target_;
  const Rotate& rotate_;
  double largest_;  // half a mean target texel, sr
};

/// Energy per target texel of a whole width x height image. The summation order does not depend on the threads.
template <class Source, class Target, class Rotate>
std::vector<vec3> project_texels(const Source& source, int width, int height, const std::vector<vec3>& values,
                                 const Target& target, int target_texels, const Rotate& rotate) {
  const TexelProjector<Source, Target, Rotate> projector(source, target, target_texels, rotate);
  using Sums = std::vector<dvec3>;
  const Sums sums = tbb::parallel_deterministic_reduce(
      tbb::blocked_range<int>(0, height, std::max(1, height / 16)), Sums(target_texels, dvec3(0.0)),
      [&](const tbb::blocked_range<int>& rows, Sums energy) {
        for (int y = rows.begin(); y < rows.end(); ++y)
          for (int x = 0; x < width; ++x)
            if (const vec3 v = values[std::size_t(y) * width + x]; v != vec3(0.0f))
              projector.add(dvec3(v), x, y, energy);
        return energy;
      },
      [](Sums a, const Sums& b) {
        for (std::size_t i = 0; i < a.size(); ++i) a[i] += b[i];
        return a;
      });
  return {sums.begin(), sums.end()};
}

struct Environment;

/// Energy per texel of a 6 x n x n cube map of a latitude-longitude image, rotation applied. Every strip between two
/// meridians that bound source or cube columns is walked from pole to pole along its middle: exact in latitude, second
/// order in the strip's width, and twenty times faster than subdivision, since lights that turn need it every frame.
std::vector<vec3> project_lat_long(const Environment& environment, int n);

}  // namespace penumbra
