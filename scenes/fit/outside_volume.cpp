#include "scenes/fit/outside_volume.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

namespace penumbra {
namespace {

/// Solid angle of the triangle (a, b, c) seen from the origin, with the determinant's sign (Van Oosterom & Strackee
/// 1983).
double solid_angle(const dvec3& a, const dvec3& b, const dvec3& c, double determinant) {
  const double la = glm::length(a), lb = glm::length(b), lc = glm::length(c);
  return 2.0 * std::atan2(determinant, la * lb * lc + glm::dot(a, b) * lc + glm::dot(b, c) * la + glm::dot(c, a) * lb);
}

/// One edge of a triangle in its plane, in polar coordinates about the foot of the perpendicular from the ball's
/// centre: the edge lies at distance d from the foot, at offsets s along it. Everything is signed by the sense of
/// rotation, and vanishes with the height h of the centre over the plane, so a centre on the surface needs no special
/// care.
class EdgePiece {
 public:
  EdgePiece(double height, double radius, double d)
      : h_(height), radius_(radius), d_(d), disc2_(std::max(0.0, radius * radius - height * height)) {}

  /// Integral of min(t, R)^3 / 3 dw over what the edge from offset s0 to s1 and the foot enclose.
  double integral(double s0, double s1) const {
    if (d_ == 0.0) return 0.0;
    const double reach = std::sqrt(std::max(0.0, disc2_ - d_ * d_));  // the edge is inside the disc for |s| < reach
    const double low = std::clamp(-reach, s0, s1), high = std::clamp(reach, s0, s1);
    return sector(s0, low) + h_ * d_ * (high - low) / 6.0 + sector(high, s1);
  }

 private:
  /// Where the edge runs outside the disc: a cone over a sector of the disc, and beyond it the ball.
  double sector(double s0, double s1) const {
    if (s0 == s1) return 0.0;
    const double angle = std::atan2(d_ * (s1 - s0), d_ * d_ + s0 * s1);
    const auto slant = [&](double s) {
      return std::asin(std::clamp(h_ * s / std::sqrt((h_ * h_ + d_ * d_) * (d_ * d_ + s * s)), -1.0, 1.0));
    };
    const double between = std::copysign(1.0, d_) * (slant(s1) - slant(s0));
    return angle * h_ * (radius_ * radius_ / 3.0 + disc2_ / 6.0) - radius_ * radius_ * radius_ / 3.0 * between;
  }

  double h_, radius_, d_, disc2_;
};

/// Volume of the ball within the cone over a triangle, up to the triangle; corners relative to the ball's centre.
double cone_volume(const dvec3 (&corner)[3], double radius) {
  const dvec3 normal = glm::cross(corner[1] - corner[0], corner[2] - corner[0]);
  const double twice_area = glm::length(normal);
  if (twice_area == 0.0) return 0.0;
  const double determinant = glm::dot(corner[0], normal), height = std::abs(determinant) / twice_area;
  if (height >= radius)  // the ball does not reach the plane
    return radius * radius * radius / 3.0 * solid_angle(corner[0], corner[1], corner[2], determinant);
  const dvec3 unit = normal / twice_area, foot = glm::dot(corner[0], unit) * unit;
  double sum = 0.0;
  for (int k = 0; k < 3; ++k) {
    const dvec3 a = corner[k] - foot, along = corner[(k + 1) % 3] - corner[k];
    const double length = glm::length(along);
    if (length == 0.0) continue;
    const dvec3 u = along / length;
    const double d = glm::dot(glm::cross(a, u), unit), s0 = glm::dot(a, u);
    sum += EdgePiece(height, radius, d).integral(s0, s0 + length);
  }
  return determinant < 0.0 ? -sum : sum;
}

}  // namespace

double outside_volume(const Mesh& solid, const Sphere& sphere) {
  const double radius = sphere.radius, ball = 4.0 / 3.0 * pi * radius * radius * radius;
  if (radius <= 0.0) return 0.0;
  const dvec3 centre = sphere.centre;
  double shared = 0.0;
  for (const uvec3& t : solid.triangles) {
    const dvec3 corner[3] = {dvec3(solid.positions[t.x]) - centre, dvec3(solid.positions[t.y]) - centre,
                             dvec3(solid.positions[t.z]) - centre};
    shared += cone_volume(corner, radius);
  }
  return std::clamp(ball - shared, 0.0, ball);
}

double outside_volume(const Mesh& solid, const SphereSet& set) {
  std::vector<double> volume(set.size());  // summed in order: the same bits for any number of threads
  tbb::parallel_for(std::size_t(0), set.size(),
                    [&](std::size_t i) { volume[i] = outside_volume(solid, set.spheres[i]); });
  double sum = 0.0;
  for (const double v : volume) sum += v;
  return sum;
}

}  // namespace penumbra
