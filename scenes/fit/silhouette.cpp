#include "scenes/fit/silhouette.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <nlopt.hpp>

#include "scenes/ray_scene.h"

namespace penumbra {
namespace {

constexpr int directions = 48, pixels = 112;

/// A parallel view: right-handed axes, a square image about the solid's centre, coverage of every pixel by the solid.
struct View {
  vec3 right, up, forward;
  std::vector<float> mask;
};

class Silhouettes {
 public:
  explicit Silhouettes(const Mesh& solid) : box_(bounds(solid)), views_(directions) {
    half_width_ = 0.55f * glm::length(box_.extent());
    pixel_ = 2.0f * half_width_ / pixels;
    const RayScene rays(solid);
    tbb::parallel_for(0, directions, [&](int v) { views_[v] = look(rays, v); });
  }

  /// Sum over views and pixels of (coverage - mask)^2, as a share of the mean mask area; adds to `gradient` by
  /// (x, y, z, radius) of every sphere.
  double loss(const std::vector<double>& x, std::vector<double>& gradient) const {
    std::vector<double> sum(directions);
    std::vector<std::vector<double>> slopes(directions);
    tbb::parallel_for(0, directions, [&](int v) { sum[v] = loss_of(views_[v], x, slopes[v]); });
    double total = 0.0;
    std::fill(gradient.begin(), gradient.end(), 0.0);
    for (int v = 0; v < directions; ++v) {  // in order: the same bits for any number of threads
      total += sum[v];
      for (std::size_t i = 0; i < gradient.size(); ++i) gradient[i] += slopes[v][i];
    }
    return total;
  }

  double area() const {
    double sum = 0.0;
    for (const View& view : views_)
      for (const float m : view.mask) sum += m;
    return sum;
  }

 private:
  View look(const RayScene& rays, int index) const {
    View view;
    const double z = (index + 0.5) / directions, angle = 2.399963229728653 * index;  // Fibonacci spiral
    view.forward = vec3(std::sqrt(1.0 - z * z) * std::cos(angle), z, std::sqrt(1.0 - z * z) * std::sin(angle));
    orthonormal_frame(view.forward, view.right, view.up);
    view.mask.resize(std::size_t(pixels) * pixels);
    constexpr int sub = 2;
    const float far = 4.0f * half_width_;
    for (int row = 0; row < pixels; ++row)
      for (int column = 0; column < pixels; ++column) {
        int hits = 0;
        for (int s = 0; s < sub * sub; ++s) {
          const int sx = s % sub, sy = s / sub;
          const float x = (float(column) + (float(sx) + 0.5f) / sub) * pixel_ - half_width_;
          const float y = (float(row) + (float(sy) + 0.5f) / sub) * pixel_ - half_width_;
          const vec3 origin = box_.centre() + x * view.right + y * view.up - 0.5f * far * view.forward;
          hits += rays.occluded(origin, view.forward, far);
        }
        view.mask[std::size_t(row) * pixels + column] = float(hits) / (sub * sub);
      }
    return view;
  }

  struct Disc {
    float x, y, radius, edge;  ///< in pixels
    int column0, column1, row0, row1;
  };
  Disc project(const View& view, const double* sphere) const {
    const vec3 offset = vec3(sphere[0], sphere[1], sphere[2]) - box_.centre();
    Disc d;
    d.x = (glm::dot(offset, view.right) + half_width_) / pixel_ - 0.5f;
    d.y = (glm::dot(offset, view.up) + half_width_) / pixel_ - 0.5f;
    d.radius = float(sphere[3]) / pixel_;
    d.edge = std::max(d.radius, 1.0f);
    const float reach = std::sqrt(d.radius * d.radius + 2.0f * d.edge);
    d.column0 = std::max(0, int(std::ceil(d.x - reach))), d.column1 = std::min(pixels - 1, int(d.x + reach));
    d.row0 = std::max(0, int(std::ceil(d.y - reach))), d.row1 = std::min(pixels - 1, int(d.y + reach));
    return d;
  }

  /// Coverage of a pixel by one disc, soft over two pixels about its edge, and its slope by (radius^2 - distance^2).
  static float cover(const Disc& d, float dx, float dy, float& slope) {
    const float u = 0.5f + 0.25f * (d.radius * d.radius - dx * dx - dy * dy) / d.edge;
    slope = 0.0f;
    if (u <= 0.0f) return 0.0f;
    if (u >= 1.0f) return 1.0f;
    slope = 6.0f * u * (1.0f - u) * 0.25f / d.edge;
    return u * u * (3.0f - 2.0f * u);
  }

  /// A pixel is covered as much as by the disc that covers it most. (A product of what each lets through would count
  /// edges that coincide twice, and shrink sets of many overlapping spheres.)
  double loss_of(const View& view, const std::vector<double>& x, std::vector<double>& slopes) const {
    const std::size_t count = x.size() / 4;
    std::vector<float> covered(view.mask.size(), 0.0f);
    std::vector<int> owner(view.mask.size(), -1);
    std::vector<Disc> discs;
    discs.reserve(count);
    float slope;
    for (std::size_t k = 0; k < count; ++k) {
      const Disc& d = discs.emplace_back(project(view, &x[4 * k]));
      for (int row = d.row0; row <= d.row1; ++row)
        for (int column = d.column0; column <= d.column1; ++column) {
          const std::size_t i = std::size_t(row) * pixels + column;
          const float alpha = cover(d, float(column) - d.x, float(row) - d.y, slope);
          if (alpha > covered[i]) covered[i] = alpha, owner[i] = int(k);
        }
    }
    double sum = 0.0;
    slopes.assign(x.size(), 0.0);
    for (std::size_t i = 0; i < covered.size(); ++i) {
      const float error = covered[i] - view.mask[i];
      sum += double(error) * double(error);
      if (owner[i] < 0) continue;
      const Disc& d = discs[owner[i]];
      const std::size_t row = i / pixels, column = i % pixels;
      const float dx = float(column) - d.x, dy = float(row) - d.y;
      cover(d, dx, dy, slope);
      const float by_square = 2.0f * error * slope;
      const vec3 by_centre = by_square * 2.0f / pixel_ * (dx * view.right + dy * view.up);
      double* at = &slopes[4 * std::size_t(owner[i])];
      for (int c = 0; c < 3; ++c) at[c] += by_centre[c];
      at[3] += by_square * 2.0f * d.radius / pixel_;
    }
    return sum;
  }

  Bounds box_;
  float half_width_, pixel_;
  std::vector<View> views_;
};

}  // namespace

SphereSet match_silhouettes(const Mesh& solid, const SphereSet& start, const FitProgress& progress) {
  if (progress) progress("drawing silhouettes", 0.0);
  struct Search {
    Silhouettes silhouettes;
    double scale, least;
    std::vector<double> best;
    int evaluations;
    const FitProgress& progress;
  } search{Silhouettes(solid), 0.0, std::numeric_limits<double>::max(), {}, 0, progress};
  if (search.silhouettes.area() == 0.0) return start;
  search.scale = 1.0 / search.silhouettes.area();
  std::vector<double> x;
  for (const Sphere& s : start.spheres) x.insert(x.end(), {s.centre.x, s.centre.y, s.centre.z, s.radius});
  constexpr int most = 400;
  nlopt::opt lbfgs(nlopt::LD_LBFGS, unsigned(x.size()));
  const auto objective = [](const std::vector<double>& at, std::vector<double>& gradient, void* data) {
    auto& s = *static_cast<Search*>(data);
    std::vector<double> slopes(at.size());
    const double value = s.silhouettes.loss(at, slopes) * s.scale;
    for (std::size_t i = 0; i < gradient.size(); ++i) gradient[i] = slopes[i] * s.scale;
    if (s.progress && s.evaluations % 16 == 0) s.progress("matching silhouettes", double(s.evaluations) / most);
    ++s.evaluations;
    if (value < s.least) s.least = value, s.best = at;
    return value;
  };
  lbfgs.set_min_objective(objective, &search);
  std::vector<double> lowest(x.size(), -1e3);
  for (std::size_t i = 3; i < lowest.size(); i += 4) lowest[i] = 0.0;
  lbfgs.set_lower_bounds(lowest);
  lbfgs.set_maxeval(most);
  lbfgs.set_ftol_rel(1e-5);
  double value = 0.0;
  try {
    lbfgs.optimize(x, value);
  } catch (const std::runtime_error&) {  // no step brings more, as at once for a ball: the best so far is the answer
  }
  x = search.best;
  SphereSet set;
  for (std::size_t i = 0; i < x.size(); i += 4)
    set.spheres.push_back({vec3(x[i], x[i + 1], x[i + 2]), float(x[i + 3])});
  return set;
}

}  // namespace penumbra
