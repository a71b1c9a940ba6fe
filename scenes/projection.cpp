#include "scenes/projection.h"

#include <algorithm>
#include <cmath>

#include "scenes/environment.h"

namespace penumbra {
namespace {

/// Where the meridian of a world longitude enters texels of a cube map, as sines of latitude, pole to pole.
class Meridian {
 public:
  struct Span {
    double low;  ///< sine of the latitude where it ends
    int texel;
  };

  void walk(double longitude, int n) {
    const double x = std::sin(longitude), z = std::cos(longitude), major = std::max(std::abs(x), std::abs(z));
    tangents_.clear();
    for (int k = 0; k <= n; ++k) tangents_.push_back((2.0 * k / n - 1.0) * major);  // rows of the side face
    for (int k = 1; k < n; ++k) {  // rows and columns of the top face, and of the bottom face
      const double grid = std::abs(2.0 * k / n - 1.0);
      for (const double component : {std::abs(x), std::abs(z)})
        if (grid > 0.0 && component / grid > major)
          tangents_.push_back(k * 2 > n ? component / grid : -component / grid);
    }
    std::sort(tangents_.begin(), tangents_.end(), std::greater<>());
    spans_.clear();
    double above = 0.5 * pi;
    for (std::size_t k = 0; k <= tangents_.size(); ++k) {
      const double below = k < tangents_.size() ? std::atan(tangents_[k]) : -0.5 * pi;
      if (below >= above) continue;
      const double middle = 0.5 * (above + below), c = std::cos(middle);
      spans_.push_back({std::sin(below), cube_texel(vec3(x * c, std::sin(middle), z * c), n)});
      above = below;
    }
  }
  const std::vector<Span>& spans() const { return spans_; }

 private:
  std::vector<double> tangents_;
  std::vector<Span> spans_;
};

/// Source longitudes that bound strips: columns of the source and of the cube's side faces, from pi down to -pi.
std::vector<double> strip_edges(const Environment& e, int n) {
  std::vector<double> edges;
  const int parts = std::max(1, 8192 / e.width);  // thin enough for the corners of texels around the poles
  for (int x = 0; x <= e.width * parts; ++x) edges.push_back(pi - 2.0 * pi * x / (e.width * parts));
  for (int face = 0; face < 4; ++face)
    for (int k = 0; k < n; ++k) {
      const double world = face * 0.5 * pi + std::atan(2.0 * k / n - 1.0);
      edges.push_back(std::remainder(world - e.rotation, 2.0 * pi));
    }
  std::sort(edges.begin(), edges.end(), std::greater<>());
  return edges;
}

}  // namespace

std::vector<vec3> project_lat_long(const Environment& e, int n) {
  const std::vector<double> edges = strip_edges(e, n);
  std::vector<double> row_sine;  // of the lower edge of each source row
  for (int y = 1; y <= e.height; ++y) row_sine.push_back(y == e.height ? -1.0 : std::cos(pi * y / e.height));

  using Sums = std::vector<dvec3>;
  const auto add_strip = [&](std::size_t strip, Meridian& meridian, Sums& energy) {
    const double width = edges[strip] - edges[strip + 1], middle = 0.5 * (edges[strip] + edges[strip + 1]);
    if (width <= 0.0) return;
    const int column = std::clamp(int((pi - middle) / (2.0 * pi) * e.width), 0, e.width - 1);
    meridian.walk(middle + e.rotation, n);
    double above = 1.0;
    int row = 0;
    for (const Meridian::Span& span : meridian.spans())
      for (;;) {
        const double below = std::max(span.low, row_sine[row]);
        energy[span.texel] += dvec3(e.radiance[std::size_t(row) * e.width + column]) * (width * (above - below));
        above = below;
        if (span.low >= row_sine[row] || row + 1 == e.height) break;
        ++row;
      }
  };
  const Sums sums = tbb::parallel_deterministic_reduce(
      tbb::blocked_range<std::size_t>(0, edges.size() - 1, edges.size() / 8 + 1),
      Sums(std::size_t(6) * n * n, dvec3(0.0)),
      [&](const tbb::blocked_range<std::size_t>& strips, Sums energy) {
        Meridian meridian;
        for (std::size_t k = strips.begin(); k < strips.end(); ++k) add_strip(k, meridian, energy);
        return energy;
      },
      [](Sums a, const Sums& b) {
        for (std::size_t i = 0; i < a.size(); ++i) a[i] += b[i];
        return a;
      });
  return {sums.begin(), sums.end()};
}

}  // namespace penumbra
