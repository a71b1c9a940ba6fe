#include "scenes/fit/outside_volume.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

namespace penumbra {
namespace {

/// Solid angle of the triangle (a, b, c) seen from the origin, >= 0 (Van Oosterom & Strackee 1983).
double solid_angle(const dvec3& a, const dvec3& b, const dvec3& c, double determinant) {
  const double la = glm::length(a), lb = glm::length(b), lc = glm::length(c);
  return 2.0 * std::atan2(std::abs(determinant),
                          la * lb * lc + glm::dot(a, b) * lc + glm::dot(b, c) * la + glm::dot(c, a) * lb);
}

/// One edge of a triangle in its plane, in polar coordinates about the foot of the perpendicular from the centre: the
/// edge lies at distance d from the foot, at offsets s along it. Everything is signed by the sense of rotation.
class EdgePiece {
 public:
  EdgePiece(double height, double radius, double d)
      : h_(height), radius_(radius), d_(d), disc2_(std::max(0.0, radius * radius - height * height)) {}

  /// Integral of (R^3 - min(t, R)^3) / 3 dw over what the edge from offset s0 to s1 and the foot enclose.
  double integral(double s0, double s1) const {
    if (d_ == 0.0) return 0.0;
    const double reach2 = disc2_ - d_ * d_;
    const double reach = reach2 > 0.0 ? std::sqrt(reach2) : 0.0;  // the edge is inside the disc for |s| < reach
    const double low = std::clamp(-reach, std::min(s0, s1), std::max(s0, s1));
    const double high = std::clamp(reach, std::min(s0, s1), std::max(s0, s1));
    const double sum = s0 < s1 ? sector(s0, low) + triangle(low, high) + sector(high, s1)
                               : sector(s0, high) + triangle(high, low) + sector(low, s1);
    return sum;
  }

 private:
  double angle(double s0, double s1) const { return std::atan2(d_ * (s1 - s0), d_ * d_ + s0 * s1); }

  /// Beyond the disc: a sector of it, of area disc^2 / 2 and solid angle 1 - h / R per radian.
  double sector(double s0, double s1) const {
    if (s0 == s1) return 0.0;
    const double cap = radius_ * radius_ * radius_ * (1.0 - std::min(1.0, h_ / radius_)) - 0.5 * h_ * disc2_;
    return cap / 3.0 * angle(s0, s1);
  }
  /// Within the disc: the triangle itself, up to its plane only.
  double triangle(double s0, double s1) const {
    if (s0 == s1) return 0.0;
    const double far2 = h_ * h_ + d_ * d_;
    const auto sine = [&](double s) { return h_ * s / std::sqrt(far2 * (d_ * d_ + s * s)); };
    const double omega = angle(s0, s1) - std::copysign(1.0, d_) * (std::asin(std::clamp(sine(s1), -1.0, 1.0)) -
                                                                   std::asin(std::clamp(sine(s0), -1.0, 1.0)));
    return radius_ * radius_ * radius_ / 3.0 * omega - h_ / 3.0 * 0.5 * d_ * (s1 - s0);
  }

  double h_, radius_, d_, disc2_;
};

/// Integral of (R^3 - min(t, R)^3) / 3 over the triangle's solid angle, >= 0; corners relative to the centre.
double hidden_volume(const dvec3 (&corner)[3], const dvec3& unit_normal, double height, double radius) {
  const dvec3 foot = glm::dot(corner[0], unit_normal) * unit_normal;
  double sum = 0.0;
  for (int k = 0; k < 3; ++k) {
    const dvec3 a = corner[k] - foot, along = corner[(k + 1) % 3] - corner[k];
    const double length = glm::length(along);
    if (length == 0.0) continue;
    const dvec3 u = along / length;
    const double d = glm::dot(glm::cross(a, u), unit_normal), s0 = glm::dot(a, u);
    sum += EdgePiece(height, radius, d).integral(s0, s0 + length);
  }
  return sum;
}

}  // namespace

double outside_volume(const Mesh& solid, const Sphere& sphere) {
  const double radius = sphere.radius, ball = 4.0 / 3.0 * pi * radius * radius * radius;
  if (radius <= 0.0) return 0.0;
  const dvec3 centre = sphere.centre;
  double winding = 0.0, hidden = 0.0;
  for (const uvec3& t : solid.triangles) {
    const dvec3 corner[3] = {dvec3(solid.positions[t.x]) - centre, dvec3(solid.positions[t.y]) - centre,
                             dvec3(solid.positions[t.z]) - centre};
    const dvec3 normal = glm::cross(corner[1] - corner[0], corner[2] - corner[0]);
    const double twice_area = glm::length(normal);
    if (twice_area == 0.0) continue;
    const double determinant = glm::dot(corner[0], normal), height = std::abs(determinant) / twice_area;
    const double sign = determinant < 0.0 ? -1.0 : 1.0;
    winding += sign * solid_angle(corner[0], corner[1], corner[2], determinant);
    if (height < radius) hidden += sign * hidden_volume(corner, normal / twice_area, height, radius);
  }
  return std::max(0.0, (1.0 - winding / (4.0 * pi)) * ball + hidden);
}

double outside_volume(const Mesh& solid, const SphereSet& set) {
  std::vector<double> volume(set.size());  // summed in order: the same bits for any number of threads
  tbb::parallel_for(std::size_t(0), set.size(), [&](std::size_t i) { volume[i] = outside_volume(solid, set.spheres[i]); });
  double sum = 0.0;
  for (const double v : volume) sum += v;
  return sum;
}

}  // namespace penumbra
