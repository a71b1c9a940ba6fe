// Rotation of functions on the sphere: R f (w) = f(Q^-1 w), a (2l + 1) x (2l + 1) matrix per band.
#pragma once

#include <span>
#include <vector>

#include "scenes/math.h"

namespace penumbra::sh {

class Rotation {
 public:
  /// `turn` is a proper rotation matrix. Entry (i, j) of a band is the integral of Y_i(Q w) Y_j(w), by a quadrature
  /// that is exact for these polynomials. Throws Error if the order is out of range or the matrix is not orthogonal.
  Rotation(int order, const glm::dmat3& turn);

  /// c has order^2 coefficients.
  std::vector<double> operator()(std::span<const double> c) const;

 private:
  int order_;
  std::vector<double> entries_;  ///< bands one after the other, row by row
};

}  // namespace penumbra::sh
