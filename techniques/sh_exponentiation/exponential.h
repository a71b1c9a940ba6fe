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

/// exp*(f) ~ a(|f|) 1 + b(|f|) f for f without DC. Even steps of |f|; beyond the last the last holds.
struct LinearFit {
  double step = 1.0;
  std::vector<float> a, b;
  template <class T>
  T look_up(const std::vector<float>& values, T norm) const {
    const T last = T(values.size() - 1), at = norm / T(step) < last ? norm / T(step) : last;  // also if not a number
    const auto k = std::min(std::size_t(at), values.size() - 2);
    return T(values[k]) + (at - T(k)) * (T(values[k + 1]) - T(values[k]));
  }
};
/// Exact on the logarithms of single caps, up to where |f| stops growing with the angle.
LinearFit fit_to_caps(const LogTable& table);
/// Least squares over random sets of spheres with the same |f|.
LinearFit fit_to_sets(const LogTable& table);

/// g = e^dc (a(|f|) 1 + b(|f|) f); the DC of f itself is not looked at.
template <class T>
void optimal_linear(const LinearFit& fit, std::span<const T> f, T dc, T* g) {
  T squared = 0;
  for (std::size_t i = 1; i < f.size(); ++i) squared += f[i] * f[i];
  const T norm = std::sqrt(squared), scale = std::exp(dc), b = scale * fit.look_up(fit.b, norm);
  g[0] = scale * fit.look_up(fit.a, norm) * T(3.5449077018110318);  // sqrt(4 pi)
  for (std::size_t i = 1; i < f.size(); ++i) g[i] = b * f[i];
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
