#include "techniques/bases/spherical_harmonics/basis.h"

#include <cmath>

#include "scenes/error.h"

namespace penumbra::sh {

void check_order(int order, int low, int high) {
  if (order < low || order > high)
    throw Error("spherical harmonics: order (number of bands) is {}, must be {} to {}", order, low, high);
}

int order_of(std::size_t coefficients) {
  int order = 1;
  while (order < max_order && std::size_t(order) * order < coefficients) ++order;
  if (std::size_t(order) * order != coefficients)
    throw Error("spherical harmonics: {} coefficients; must be the square of an order from 1 to {}", coefficients,
                max_order);
  return order;
}

namespace {

/// P_l^m(x) with Condon-Shortley phase, by the recurrence upwards in l (Green 2003, section 3).
double associated_legendre(int l, int m, double x) {
  double mm = 1.0;  // P_m^m = (-1)^m (2m - 1)!! (1 - x^2)^(m/2)
  for (int k = 1; k <= m; ++k) mm *= -(2.0 * k - 1.0) * std::sqrt(std::max(0.0, 1.0 - x * x));
  if (l == m) return mm;
  double before = mm, at = x * (2.0 * m + 1.0) * mm;
  for (int k = m + 2; k <= l; ++k) {
    const double next = ((2.0 * k - 1.0) * x * at - (k + m - 1.0) * before) / (k - m);
    before = at, at = next;
  }
  return at;
}

double normalisation(int l, int m) {
  double ratio = 1.0;  // (l - m)! / (l + m)!
  for (int k = l - m + 1; k <= l + m; ++k) ratio /= k;
  return std::sqrt((2.0 * l + 1.0) / (4.0 * pi) * ratio);
}

}  // namespace

double legendre(int l, double x) {
  return associated_legendre(l, 0, x);
}

std::vector<double> evaluate(int order, dvec3 direction) {
  check_order(order);
  const double phi = std::atan2(direction.y, direction.x);
  std::vector<double> y(std::size_t(coefficients(order)));
  for (int l = 0; l < order; ++l) {
    y[index(l, 0)] = normalisation(l, 0) * associated_legendre(l, 0, direction.z);
    for (int m = 1; m <= l; ++m) {
      const double polar = std::sqrt(2.0) * normalisation(l, m) * associated_legendre(l, m, direction.z);
      y[index(l, m)] = polar * std::cos(m * phi);
      y[index(l, -m)] = polar * std::sin(m * phi);
    }
  }
  return y;
}

double reconstruct(std::span<const double> c, dvec3 direction) {
  const std::vector<double> y = evaluate(order_of(c.size()), direction);
  double sum = 0.0;
  for (std::size_t i = 0; i < c.size(); ++i) sum += c[i] * y[i];
  return sum;
}

GaussLegendre gauss_legendre(int count) {
  GaussLegendre out;
  for (int i = 0; i < count; ++i) {
    double x = std::cos(pi * (i + 0.75) / (count + 0.5)), slope = 1.0;
    for (int step = 0; step < 64; ++step) {  // Newton on P_count; P' from the recurrence
      const double at = legendre(count, x);
      slope = count * (x * at - legendre(count - 1, x)) / (x * x - 1.0);
      const double move = at / slope;
      x -= move;
      if (std::abs(move) < 1e-15) break;
    }
    out.node.push_back(x);
    out.weight.push_back(2.0 / ((1.0 - x * x) * slope * slope));
  }
  return out;
}

Quadrature quadrature(int degree) {
  const GaussLegendre polar = gauss_legendre(degree / 2 + 1);
  const int around = degree + 1;
  Quadrature out;
  for (std::size_t i = 0; i < polar.node.size(); ++i) {
    const double z = polar.node[i], sine = std::sqrt(1.0 - z * z);
    for (int k = 0; k < around; ++k) {
      const double phi = 2.0 * pi * k / around;
      out.direction.emplace_back(sine * std::cos(phi), sine * std::sin(phi), z);
      out.weight.push_back(polar.weight[i] * 2.0 * pi / around);
    }
  }
  return out;
}

}  // namespace penumbra::sh
