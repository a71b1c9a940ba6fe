#include "techniques/bases/spherical_harmonics/rotation.h"

#include <cmath>

#include "scenes/error.h"
#include "techniques/bases/spherical_harmonics/basis.h"

namespace penumbra::sh {

Rotation::Rotation(int order, const glm::dmat3& turn) : order_(order) {
  check_order(order);
  const glm::dmat3 unit = turn * glm::transpose(turn);
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k < 3; ++k)
      if (!(std::abs(unit[i][k] - (i == k ? 1.0 : 0.0)) < 1e-6))
        throw Error("spherical harmonics: the rotation matrix is not orthogonal");
  std::size_t size = 0;
  for (int l = 0; l < order; ++l) size += std::size_t(2 * l + 1) * (2 * l + 1);
  entries_.assign(size, 0.0);
  const Quadrature q = quadrature(2 * (order - 1));
  for (std::size_t p = 0; p < q.weight.size(); ++p) {
    const std::vector<double> before = evaluate(order, q.direction[p]), after = evaluate(order, turn * q.direction[p]);
    double* entry = entries_.data();
    for (int l = 0; l < order; ++l)
      for (int i = index(l, -l); i <= index(l, l); ++i)
        for (int j = index(l, -l); j <= index(l, l); ++j) *entry++ += q.weight[p] * after[i] * before[j];
  }
}

std::vector<double> Rotation::operator()(std::span<const double> c) const {
  if (c.size() != std::size_t(coefficients(order_)))
    throw Error("spherical harmonics: {} coefficients given to a rotation of order {}", c.size(), order_);
  std::vector<double> out(c.size(), 0.0);
  const double* entry = entries_.data();
  for (int l = 0; l < order_; ++l)
    for (int i = index(l, -l); i <= index(l, l); ++i)
      for (int j = index(l, -l); j <= index(l, l); ++j) out[i] += *entry++ * c[j];
  return out;
}

}  // namespace penumbra::sh
