// Rotation of functions on the sphere: R f (w) = f(Q^-1 w), a (2l + 1) x (2l + 1) matrix per band.
#pragma once

#include <span>
#include <vector>

#include "scenes/math.h"

namespace penumbra::sh {

class Rotation {
 public:
  /// `turn` is a proper rotation matrix, Q. Entry (i, j) of a band is the integral of Y_i(Q w) Y_j(w), made from those
  /// of the band before (Ivanic & Ruedenberg 1996, with the corrections of 1998). Throws Error if the order is out of
  /// range or the matrix is not orthogonal.
  Rotation(int order, const glm::dmat3& turn);

  /// c has order^2 coefficients.
  std::vector<double> operator()(std::span<const double> c) const;
  /// The same in single precision. `out` must not be c.
  void operator()(const float* c, float* out) const;

  int order() const { return order_; }
  /// Bands one after the other, row by row, in single precision.
  const float* entries() const { return narrow_.data(); }

 private:
  int order_;
  std::vector<double> entries_;
  std::vector<float> narrow_;
};

/// out = R f, item by item, of a batch (kernel.h). `out` may be f.
void rotate_batch(const Rotation& rotation, const float* f, int count, float* out);

}  // namespace penumbra::sh
