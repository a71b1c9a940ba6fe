// The real spherical harmonics basis in double precision, as the textbook has it: the oracle of everything faster.
//
//   Y_l0 = K_l0 P_l(z),  Y_lm = sqrt 2 K_lm cos(m phi) P_l^m(z)  (m > 0),  sqrt 2 K_l|m| sin(|m| phi) P_l^|m|(z)  (m <
//   0) K_lm = sqrt((2l + 1) / (4 pi) (l - |m|)! / (l + |m|)!)
//
// with the Condon-Shortley phase (-1)^m inside P, polar axis z, phi from x towards y (Green 2003, section 3). Order n
// means the bands l < n: n^2 coefficients; coefficient (l, m) has the index l (l + 1) + m.
#pragma once

#include <span>
#include <vector>

#include "scenes/math.h"

namespace penumbra::sh {

inline constexpr int max_order = 10;

PENUMBRA_HD constexpr int coefficients(int order) {
  return order * order;
}
PENUMBRA_HD constexpr int index(int l, int m) {
  return l * (l + 1) + m;
}
/// Band of a coefficient's index.
PENUMBRA_HD constexpr int band(int index) {
  int l = 0;
  while ((l + 1) * (l + 1) <= index) ++l;
  return l;
}
/// Order of so many coefficients. Throws Error unless it is the square of 1 to max_order.
int order_of(std::size_t coefficients);

/// Throws Error unless low <= order <= high.
void check_order(int order, int low = 1, int high = max_order);

/// All n^2 basis functions in a unit direction.
std::vector<double> evaluate(int order, dvec3 direction);

/// Legendre polynomial P_l(x).
double legendre(int l, double x);

/// sum of c_i Y_i(direction).
double reconstruct(std::span<const double> c, dvec3 direction);

/// Directions and weights (sr) that integrate every polynomial of the sphere up to `degree` exactly: Gauss-Legendre in
/// z times equal steps in phi.
struct Quadrature {
  std::vector<dvec3> direction;
  std::vector<double> weight;
};
Quadrature quadrature(int degree);

/// Nodes in [-1, 1] and weights of Gauss-Legendre integration with `count` points.
struct GaussLegendre {
  std::vector<double> node, weight;
};
GaussLegendre gauss_legendre(int count);

}  // namespace penumbra::sh
