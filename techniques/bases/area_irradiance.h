// Light from a whole lamp without any occluder, in closed form.
//
// Irradiance of a lamp of even radiance L whose rim is a closed curve x, seen from the receiver (Lambert 1760; Arvo
// 1995, section 2.2):
//   E = L / 2 * N . sum_k Gamma_k,   Gamma_k = theta_k * (r_k x r_k+1) / |r_k x r_k+1|      (a polygon)
//   E = L / 2 * N . integral (x cross dx) / |x|^2                                           (any rim)
// r_k the unit vectors to its corners, theta_k the angle between r_k and r_k+1. What lies below the receiver's horizon
// is clipped away first. Reflected radiance is albedo / pi * E; form_factor() is E / (pi L), 1 for a lamp that fills
// the sky.
//
// A disc of radius r, h above and d beside the receiver, z the unit vector to its plane, e the one to its axis: the
// integral over the circle is elementary. With S = sqrt((B + C) (B - C)), B = d^2 + h^2 + r^2, C = 2 r d,
//   E / (pi L) = N . F,   F = z/2 (1 - (B - 2 r^2) / S) + e h / (2 d) (B / S - 1),
// the configuration factors of a plane element parallel and perpendicular to a disc (Howell's catalogue, B-13 and
// B-14). Written so that neither a far lamp nor the axis cancels: S^2 - (B - 2 r^2)^2 = (2 r h)^2, B^2 - S^2 = C^2.
#pragma once

#include <cmath>

#include "scenes/light.h"

namespace penumbra {

/// A lamp as a parallelogram, counter-clockwise seen from the side it shines to, or as a disc. A lamp without area has
/// neither radius nor distinct corners.
struct LampOutline {
  int count = 0;  ///< of corners; 0 for a disc
  vec3 corner[4] = {};
  float radius = 0.0f;  ///< of a disc, m; 0 for a parallelogram
  vec3 centre{0.0f}, normal{0, -1, 0};
};
LampOutline make_outline(const AreaLight& light);

/// theta * (a x b) / |a x b| for unit vectors.
PENUMBRA_HD inline vec3 edge_vector(vec3 a, vec3 b) {
  const vec3 cross = glm::cross(a, b);
  const float sine = glm::length(cross), cosine = glm::dot(a, b);
  return sine > 0.0f ? cross * (std::atan2(sine, cosine) / sine) : cross;
}

/// E / (pi L) of a parallelogram at a receiver before it.
PENUMBRA_HD inline float polygon_factor(const LampOutline& lamp, vec3 position, vec3 normal) {
  vec3 first(0.0f), last(0.0f), sum(0.0f);
  bool any = false;
  const auto visit = [&](vec3 corner) {  // the clipped polygon, corner by corner
    const float length = glm::length(corner);
    if (!(length > 0.0f)) return;
    corner /= length;
    if (any) sum += edge_vector(last, corner);
    else first = corner;
    last = corner;
    any = true;
  };
  for (int k = 0; k < lamp.count; ++k) {
    const vec3 a = lamp.corner[k] - position, b = lamp.corner[k + 1 < lamp.count ? k + 1 : 0] - position;
    const float above_a = glm::dot(normal, a), above_b = glm::dot(normal, b);
    if (above_a >= 0.0f) visit(a);
    if ((above_a < 0.0f) != (above_b < 0.0f)) visit(a + above_a / (above_a - above_b) * (b - a));
  }
  if (!any) return 0.0f;
  sum += edge_vector(last, first);
  const float factor = glm::dot(normal, sum) * float(0.5 / pi);
  return factor > 0.0f ? factor : 0.0f;
}

/// E / (pi L) of a disc that the horizon cuts, before the receiver. Symbols as above, `to` its centre from the
/// receiver.
///
/// The rim above the horizon is the arc phi0 -+ alpha, phi counted from e;
///   x cross dx = r ((r + d cos phi) z - h (cos phi e + sin phi z cross e)) dphi,   |x|^2 = B + C cos phi
/// give three elementary integrals. The chord that closes the rim lies on the horizon, so that its Gamma is its angle
/// times N. In double: what a small lamp gives is a difference of long rims.
PENUMBRA_HD inline double cut_disc_factor(dvec3 to, dvec3 lamp_normal, dvec3 normal, double r) {
  const dvec3 z = -glm::normalize(lamp_normal);
  const double h = glm::dot(to, z), upright = glm::dot(normal, z);
  const dvec3 lean = normal - upright * z;
  const double m = glm::length(lean);
  if (!(h > 0.0 && m > 0.0)) return 0.0;
  const double x = glm::dot(to, lean) / m, y = glm::dot(to, glm::cross(z, lean)) / m;  // d cos phi0, -d sin phi0
  const double d = std::sqrt(x * x + y * y), cos0 = d > 0.0 ? x / d : 1.0, sin0 = d > 0.0 ? -y / d : 0.0;
  const double edge = -(upright * h + m * x) / (r * m);  // cos alpha
  const double cosine = edge < -1.0 ? -1.0 : edge > 1.0 ? 1.0 : edge;
  const double alpha = std::acos(cosine), sine = std::sqrt((1.0 - cosine) * (1.0 + cosine));

  const double b = d * d + h * h + r * r, c = 2.0 * r * d;
  const double s = std::sqrt(((d + r) * (d + r) + h * h) * ((d - r) * (d - r) + h * h));
  const double even = 2.0 / s * std::atan2(s * sine, b * cosine + c * cos0);  // of dphi / |x|^2
  const double middle = b + c * cos0 * cosine, ratio = c * sin0 * sine / middle;
  const double steep = ratio < -1.0 + 1e-15 ? -1.0 + 1e-15 : ratio > 1.0 - 1e-15 ? 1.0 - 1e-15 : ratio;
  const double sines = 2.0 * sin0 * sine / middle * (steep != 0.0 ? std::atanh(steep) / steep : 1.0);
  const double square = alpha + sine * cosine * (cos0 * cos0 - sin0 * sin0);  // of cos^2 phi dphi
  const double cosines =
      c > 1e-5 * b ? (2.0 * alpha - b * even) / c : (2.0 * sine * cos0 - c / b * square) / b;  // the axis: a series

  const double depth = x + r * cosine, away = h * h + depth * depth, half = r * sine;
  const double chord = std::atan2(2.0 * half * std::sqrt(away), away + y * y - half * half);
  const double arc = r * (upright * (r * even + d * cosines) - h * m * (cos0 * cosines + sin0 * sines));
  const double factor = (arc + std::sqrt(upright * upright + m * m) * chord) * (0.5 / pi);
  return factor > 0.0 ? factor : 0.0;
}

/// E / (pi L) of a disc at a receiver before it, `to` its centre from there. In float 1e-5 of what a receiver would get
/// that faces the lamp; h and d are differences of coordinates, and a receiver near rim or plane feels their rounding.
template <class Real>
PENUMBRA_HD inline Real disc_factor(glm::vec<3, Real> to, glm::vec<3, Real> lamp_normal, glm::vec<3, Real> normal,
                                    Real r) {
  const Real h = -glm::dot(lamp_normal, to), upright = -glm::dot(lamp_normal, normal);
  const Real above = glm::dot(normal, to), reach = r * glm::length(normal + upright * lamp_normal);
  if (above <= -reach) return Real(0);
  if (above < reach) return Real(cut_disc_factor(dvec3(to), dvec3(lamp_normal), dvec3(normal), double(r)));
  const glm::vec<3, Real> beside = to + h * lamp_normal;
  const Real d = glm::length(beside), b = d * d + h * h + r * r, a = d * d + h * h - r * r;
  const Real s = std::sqrt((d + r) * (d + r) + h * h) * std::sqrt((d - r) * (d - r) + h * h);
  const Real k = Real(2) * r * h / s;
  const Real facing = a > Real(0) ? k * (r * h / (s + a)) : (s - a) / (Real(2) * s);
  const Real factor = upright * facing + glm::dot(normal, beside) * (k * (r / (b + s)));
  return factor > Real(0) ? factor : Real(0);
}

/// E / (pi L) of a lamp at a receiver; 0 behind the lamp and where it lies below the horizon.
PENUMBRA_HD inline float form_factor(const LampOutline& lamp, vec3 position, vec3 normal) {
  if (!(glm::dot(lamp.normal, position - lamp.centre) > 0.0f)) return 0.0f;
  if (lamp.radius > 0.0f) return disc_factor(lamp.centre - position, lamp.normal, normal, lamp.radius);
  return polygon_factor(lamp, position, normal);
}

}  // namespace penumbra
