// FLIP (Andersson, Nilsson, Akenine-Moeller, Oskarsson, Astrom, Fairchild 2020, "FLIP: A Difference Evaluator for
// Alternating Images"), evaluated on HDR input at one exposure as HDR-FLIP does for each of its exposures (2021).
#include <algorithm>
#include <cmath>

#include "harness/results/filter.h"
#include "harness/results/metrics.h"

namespace penumbra {
namespace {

constexpr double pixels_per_degree = 0.7 * 3840 / 0.7 * pi / 180.0;  // 0.7 m from a 0.7 m wide 3840-pixel display

using Planes = std::array<std::vector<float>, 3>;

const glm::dmat3 xyz_of_rgb = glm::transpose(glm::dmat3(  // rows of the linear sRGB to XYZ matrix, D65
    10135552.0 / 24577794.0, 8788810.0 / 24577794.0, 4435075.0 / 24577794.0,  //
    2613072.0 / 12288897.0, 8788810.0 / 12288897.0, 887015.0 / 12288897.0,    //
    1425312.0 / 73733382.0, 8788810.0 / 73733382.0, 70074185.0 / 73733382.0));
const glm::dmat3 rgb_of_xyz = glm::inverse(xyz_of_rgb);
const dvec3 white = xyz_of_rgb * dvec3(1.0);

/// ACES fit of Narkowicz with the 0.6 exposure bias, as in HDR-FLIP; clamped to [0, 1].
double tone_map(double x) {
  x *= 0.6;
  return std::clamp(x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14), 0.0, 1.0);
}

/// The linearised opponent space in which contrast sensitivity is applied.
dvec3 to_opponent(dvec3 rgb) {
  const dvec3 xyz = xyz_of_rgb * rgb / white;
  return {116.0 * xyz.y - 16.0, 500.0 * (xyz.x - xyz.y), 200.0 * (xyz.y - xyz.z)};
}

dvec3 from_opponent(dvec3 o) {
  const double y = (o.x + 16.0) / 116.0;
  return rgb_of_xyz * (dvec3(y + o.y / 500.0, y, y - o.z / 200.0) * white);
}

/// CIELAB with the Hunt adjustment: chroma fades with lightness.
dvec3 to_lab(dvec3 rgb) {
  const dvec3 xyz = xyz_of_rgb * rgb / white;
  const auto f = [](double t) {
    const double delta = 6.0 / 29.0;
    return t > delta * delta * delta ? std::cbrt(t) : t / (3.0 * delta * delta) + 4.0 / 29.0;
  };
  const double fx = f(xyz.x), fy = f(xyz.y), fz = f(xyz.z), lightness = 116.0 * fy - 16.0;
  return {lightness, 0.01 * lightness * 500.0 * (fx - fy), 0.01 * lightness * 200.0 * (fy - fz)};
}

double hyab(dvec3 a, dvec3 b) {
  return std::abs(a.x - b.x) + std::hypot(a.y - b.y, a.z - b.z);
}

/// Weight of a sensitivity term a sqrt(pi / b) exp(-pi^2 x^2 / b), x in degrees: a Gaussian of sigma = sqrt(b / 2) /
/// pi.
struct Sensitivity {
  double a, b;
  double sigma() const { return std::sqrt(0.5 * b) / pi * pixels_per_degree; }
  double mass() const {  // of the sampled, not normalised, two-dimensional kernel
    double sum = 0.0;
    for (int x = -radius(); x <= radius(); ++x) sum += std::exp(-0.5 * x * x / (sigma() * sigma()));
    return a * std::sqrt(pi / b) * sum * sum;
  }
  static int radius() { return int(std::ceil(3.0 * std::sqrt(0.04 / (2.0 * pi * pi)) * pixels_per_degree)); }
};

std::vector<float> perceived(const std::vector<float>& plane, int width, int height,
                             const std::vector<Sensitivity>& terms) {
  std::vector<double> sum(plane.size(), 0.0);
  double mass = 0.0;
  for (const Sensitivity& term : terms) {
    const Kernel kernel = gaussian_kernel(term.sigma(), Sensitivity::radius());
    const auto part = filter(plane, width, height, kernel, kernel);
    mass += term.mass();
    for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += term.mass() * double(part[i]);
  }
  std::vector<float> out(plane.size());
  for (std::size_t i = 0; i < sum.size(); ++i) out[i] = float(sum[i] / mass);
  return out;
}

/// Strength of edges and points in achromatic planes: first and second derivatives of a Gaussian.
struct Features {
  std::vector<float> edge, point;
};

Features features(const std::vector<float>& achromatic, int width, int height) {
  const double sigma = 0.5 * 0.082 * pixels_per_degree;
  const int radius = int(std::ceil(3.0 * sigma));
  const Kernel smooth = gaussian_kernel(sigma, radius);
  Kernel first, second;
  for (int x = -radius; x <= radius; ++x) {
    const double g = std::exp(-0.5 * x * x / (sigma * sigma));
    first.push_back(-x * g);
    second.push_back((x * x / (sigma * sigma) - 1.0) * g);
  }
  for (Kernel* kernel : {&first, &second}) {  // positive and negative weights sum to 1 and -1
    double positive = 0.0, negative = 0.0;
    for (const double k : *kernel) (k > 0 ? positive : negative) += k;
    for (double& k : *kernel) k /= k > 0 ? positive : -negative;
  }
  const auto strength = [&](const Kernel& derivative) {
    auto dx = filter(achromatic, width, height, derivative, smooth);
    const auto dy = filter(achromatic, width, height, smooth, derivative);
    for (std::size_t i = 0; i < dx.size(); ++i) dx[i] = std::hypot(dx[i], dy[i]);
    return dx;
  };
  return {strength(first), strength(second)};
}

struct Prepared {
  std::vector<dvec3> lab;
  Features features;
};

Prepared prepare(const Image& image, double exposure) {
  Planes opponent;
  std::vector<float> achromatic;
  for (const vec3& p : image.pixels) {
    const dvec3 o = to_opponent(
        {tone_map(exposure * double(p.x)), tone_map(exposure * double(p.y)), tone_map(exposure * double(p.z))});
    for (int c = 0; c < 3; ++c) opponent[c].push_back(float(o[c]));
    achromatic.push_back(float((o.x + 16.0) / 116.0));
  }
  const int w = image.width, h = image.height;
  const Planes seen = {perceived(opponent[0], w, h, {{1.0, 0.0047}}), perceived(opponent[1], w, h, {{1.0, 0.0053}}),
                       perceived(opponent[2], w, h, {{34.1, 0.04}, {13.5, 0.025}})};
  Prepared out{{}, features(achromatic, w, h)};
  for (std::size_t i = 0; i < image.pixels.size(); ++i)
    out.lab.push_back(to_lab(glm::clamp(from_opponent({seen[0][i], seen[1][i], seen[2][i]}), 0.0, 1.0)));
  return out;
}

}  // namespace

std::vector<float> flip_map(const Image& image, const Image& reference, double exposure) {
  const Prepared a = prepare(image, exposure), b = prepare(reference, exposure);
  const double largest = std::pow(hyab(to_lab({0, 1, 0}), to_lab({0, 0, 1})), 0.7), knee = 0.4 * largest;
  std::vector<float> map(image.pixels.size());
  for (std::size_t i = 0; i < map.size(); ++i) {
    const double d = std::pow(hyab(a.lab[i], b.lab[i]), 0.7);
    const double colour = d < knee ? 0.95 / knee * d : 0.95 + 0.05 * (d - knee) / (largest - knee);
    const double edge = std::abs(double(a.features.edge[i]) - double(b.features.edge[i]));
    const double point = std::abs(double(a.features.point[i]) - double(b.features.point[i]));
    const double feature = std::sqrt(std::max(edge, point) / std::sqrt(2.0));
    map[i] = float(std::pow(colour, 1.0 - feature));
  }
  return map;
}

}  // namespace penumbra
