// Logarithm and exponential in the spherical harmonics basis, in double precision (Ren et al. 2006).
//
// exp*(f) = exp(M_f) 1 with the matrix M_f of multiplication by f: 1 + f + f * f / 2 + f * f * f / 6 + ..., associated
// from the left. log* undoes it: log*(g) = R^T q(D) R (g - 1), M_g = R^T D R, q(d) = ln d / (d - 1). Visibilities of
// spheres multiply, so their logarithms add.
#pragma once

#include <algorithm>
#include <cmath>
#include <span>
#include <string>
#include <vector>

#include "scenes/math.h"

namespace penumbra::sh_exponentiation {

/// Zonal logarithm of the visibility behind a cap of angular radius theta, radians: one coefficient per band.
/// Eigenvalues below 0.02 of the largest of M_g are raised to it.
std::vector<double> cap_logarithm(int order, double theta);

/// The logarithms of all caps from 0 to 90 degrees, evenly in cos theta, in which they are smooth and start linearly.
/// Rows already hold sqrt(4 pi / (2 l + 1)) f_l, what the turned basis functions are multiplied by.
class LogTable {
 public:
  static constexpr int samples = 1024;
  explicit LogTable(int order);
  int order() const { return order_; }
  const std::vector<float>& rows() const { return rows_; }
  /// Linear between samples.
  double look_up(int band, double cos_theta) const;
  std::size_t bytes() const { return rows_.size() * sizeof(float); }

 private:
  int order_;
  std::vector<float> rows_;
};

/// Linear between `count` values at even steps of 1; beyond the last the last holds.
template <class T, class Values>
PENUMBRA_HD T look_up_linear(const Values& values, int count, T at) {
  const T last = T(count - 1);
  at = at < last ? at : last;  // also if not a number
  const int k = int(at) < count - 2 ? int(at) : count - 2;
  return T(values[unsigned(k)]) + (at - T(k)) * (T(values[unsigned(k + 1)]) - T(values[unsigned(k)]));
}

/// exp*(f) ~ a(|f|) 1 + b(|f|) f for f without DC. Even steps of |f|.
struct LinearFit {
  double step = 1.0;
  std::vector<float> a, b;
  template <class T>
  T look_up_a(T norm) const {
    return look_up_linear(a, int(a.size()), norm / T(step));
  }
  template <class T>
  T look_up_b(T norm) const {
    return look_up_linear(b, int(b.size()), norm / T(step));
  }
};
/// Exact on the logarithms of single caps, up to where |f| stops growing with the angle.
LinearFit fit_to_caps(const LogTable& table);
/// Least squares over random sets of spheres with the same |f|.
LinearFit fit_to_sets(const LogTable& table);

/// g = e^dc (a(|f|) 1 + b(|f|) f) for f of `size` coefficients; the DC of f itself is not looked at. g may be f.
template <class Fit, class T>
PENUMBRA_HD void optimal_linear(const Fit& fit, const T* f, int size, T dc, T* g) {
  T squared = 0;
  for (int i = 1; i < size; ++i) squared += f[i] * f[i];
  const T norm = std::sqrt(squared), scale = std::exp(dc), b = scale * fit.look_up_b(norm);
  g[0] = scale * fit.look_up_a(norm) * T(3.5449077018110318);  // sqrt(4 pi)
  for (int i = 1; i < size; ++i) g[i] = b * f[i];
}

enum class Exponential { optimal_linear, hybrid, power_series, exact };
/// Throws Error listing the names.
Exponential parse_exponential(const std::string& name);

struct Method {
  Exponential kind = Exponential::hybrid;
  int terms = 9;      ///< power_series: the highest power
  double tau = 0.25;  ///< hybrid: |f| is halved until it is no more than this, and the result squared as often
};

/// exp*(f). DC is exponentiated on its own: exp*(f) = e^(f_0 / sqrt(4 pi)) exp*(f without DC).
/// Throws Error if terms < 0 or tau <= 0.
std::vector<double> exponential(const Method& method, const LinearFit& fit, std::span<const double> f);

}  // namespace penumbra::sh_exponentiation
