#include "techniques/sh_exponentiation/exponential.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "scenes/error.h"
#include "techniques/bases/random.h"
#include "techniques/bases/spherical_harmonics/basis.h"
#include "techniques/bases/spherical_harmonics/lobes.h"
#include "techniques/bases/spherical_harmonics/tensor.h"

namespace penumbra::sh_exponentiation {
namespace {

const double root_4pi = std::sqrt(4.0 * pi);

double norm_without_dc(std::span<const double> f) {
  double squared = 0.0;
  for (std::size_t i = 1; i < f.size(); ++i) squared += f[i] * f[i];
  return std::sqrt(squared);
}

Eigen::Map<const Eigen::MatrixXd> square_matrix(const std::vector<double>& entries) {
  const auto size = Eigen::Index(std::lround(std::sqrt(double(entries.size()))));
  return {entries.data(), size, size};
}

double largest_eigenvalue(const std::vector<double>& entries) {
  return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(square_matrix(entries), Eigen::EigenvaluesOnly)
      .eigenvalues()
      .maxCoeff();
}

/// exp(M_f) 1 by eigenvectors of M_f.
std::vector<double> exact(std::span<const double> f) {
  const auto size = Eigen::Index(f.size());
  const std::vector<double> entries = sh::tensor(sh::order_of(f.size())).matrix(f);
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(square_matrix(entries));
  Eigen::VectorXd one = Eigen::VectorXd::Zero(size);
  one[0] = root_4pi;
  const Eigen::VectorXd result =
      eigen.eigenvectors() *
      (eigen.eigenvalues().array().exp() * (eigen.eigenvectors().transpose() * one).array()).matrix();
  return {result.begin(), result.end()};
}

}  // namespace

std::vector<double> cap_logarithm(int order, double theta) {
  const sh::Zonal g = sh::cap_visibility(order, theta);
  // Products of zonal functions are zonal: the block of m = 0 is all of M_g that 1 and g can reach.
  std::vector<double> full(std::size_t(sh::coefficients(order)), 0.0);
  for (int l = 0; l < order; ++l) full[sh::index(l, 0)] = g[l];
  const std::vector<double> entries = sh::tensor(order).matrix(full);
  Eigen::MatrixXd m(order, order);
  Eigen::VectorXd rest(order);
  for (int j = 0; j < order; ++j) {
    for (int k = 0; k < order; ++k) m(j, k) = entries[sh::index(j, 0) * full.size() + sh::index(k, 0)];
    rest[j] = g[j] - (j == 0 ? root_4pi : 0.0);
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(m);
  const double least = 0.02 * largest_eigenvalue(entries);
  const Eigen::VectorXd q = eigen.eigenvalues().unaryExpr([&](double value) {
    const double d = std::max(value, least);
    return std::abs(d - 1.0) < 1e-9 ? 1.0 : std::log(d) / (d - 1.0);
  });
  const Eigen::VectorXd f = eigen.eigenvectors() * q.asDiagonal() * (eigen.eigenvectors().transpose() * rest);
  return {f.begin(), f.end()};
}

LogTable::LogTable(int order) : order_(order) {
  sh::check_order(order, 2, 6);
  for (int k = 0; k < samples; ++k) {
    const std::vector<double> f = cap_logarithm(order, std::acos(1.0 - double(k) / (samples - 1)));
    for (int l = 0; l < order; ++l)
      rows_.push_back(k == 0 ? 0.0f : float(std::sqrt(4.0 * pi / (2.0 * l + 1.0)) * f[l]));
  }
}

double LogTable::look_up(int band, double cos_theta) const {
  const double at = (1.0 - cos_theta) * (samples - 1), last = samples - 2;
  const int row = at > 0.0 ? int(std::min(at, last)) : 0;
  const double low = double(rows_[row * order_ + band]), high = double(rows_[(row + 1) * order_ + band]);
  return low + (at - row) * (high - low);
}

namespace {

constexpr int fit_samples = 257;

struct FitPoint {
  double norm, a, b;
};

/// Resamples points of growing norm, which start at (0, 1, 1), evenly.
LinearFit resampled(const std::vector<FitPoint>& points) {
  LinearFit fit;
  fit.step = points.back().norm / (fit_samples - 1);
  std::size_t k = 0;
  for (int i = 0; i < fit_samples; ++i) {
    const double norm = i * fit.step;
    while (k + 2 < points.size() && points[k + 1].norm < norm) ++k;
    const FitPoint &low = points[k], &high = points[k + 1];
    const double share = std::clamp((norm - low.norm) / (high.norm - low.norm), 0.0, 1.0);
    fit.a.push_back(float(low.a + share * (high.a - low.a)));
    fit.b.push_back(float(low.b + share * (high.b - low.b)));
  }
  return fit;
}

}  // namespace

LinearFit fit_to_caps(const LogTable& table) {
  const int order = table.order();
  std::vector<FitPoint> points = {{0.0, 1.0, 1.0}};
  for (int k = 1; k < LogTable::samples; ++k) {
    const double theta = std::acos(1.0 - double(k) / (LogTable::samples - 1));
    const std::vector<double> f = cap_logarithm(order, theta);
    const sh::Zonal v = sh::cap_visibility(order, theta);
    const double norm = norm_without_dc(f), dc = std::exp(-f[0] / root_4pi);
    if (norm <= points.back().norm) break;  // it turns back: one |f| would mean two caps
    double dot = 0.0;
    for (int l = 1; l < order; ++l) dot += dc * v[l] * f[l];
    points.push_back({norm, dc * v[0] / root_4pi, dot / (norm * norm)});
  }
  return resampled(points);
}

LinearFit fit_to_sets(const LogTable& table) {
  const int order = table.order();
  constexpr int sets = 4096, bins = 32;
  struct Bin {
    double count = 0, norm = 0, a = 0, dot = 0, squared = 0;
  };
  std::vector<Bin> found(bins);
  const double widest = 8.0;
  for (std::uint32_t set = 0; set < sets; ++set) {
    // One to 64 spheres on a patch of the sky, of such a size that every |f| occurs.
    const RandomTriple r = random_triple(set, 0);
    const int count = 1 << int(7.0f * r.x);
    std::vector<double> f(std::size_t(sh::coefficients(order)), 0.0);
    for (std::uint32_t k = 0; k < std::uint32_t(count); ++k) {
      const RandomTriple s = random_triple(set, k + 1);
      const double theta = double(r.y) * 1.2 / std::sqrt(count) * (0.3 + double(s.z)), tilt = double(r.z * s.x) * pi,
                   phi = 2.0 * pi * double(s.y);
      const std::vector<double> y =
          sh::evaluate(order, {std::sin(tilt) * std::cos(phi), std::sin(tilt) * std::sin(phi), std::cos(tilt)});
      for (std::size_t i = 0; i < f.size(); ++i) f[i] += table.look_up(sh::band(int(i)), std::cos(theta)) * y[i];
    }
    f[0] = 0.0;
    const double norm = norm_without_dc(f);
    if (!(norm < widest)) continue;
    const std::vector<double> g = exact(f);
    Bin& bin = found[std::size_t(norm / widest * bins)];
    bin.count += 1.0, bin.norm += norm, bin.a += g[0] / root_4pi, bin.squared += norm * norm;
    for (std::size_t i = 1; i < f.size(); ++i) bin.dot += g[i] * f[i];
  }
  std::vector<FitPoint> points = {{0.0, 1.0, 1.0}};
  for (const Bin& bin : found)
    if (bin.count > 0.0) points.push_back({bin.norm / bin.count, bin.a / bin.count, bin.dot / bin.squared});
  return resampled(points);
}

Exponential parse_exponential(const std::string& name) {
  if (name == "optimal-linear") return Exponential::optimal_linear;
  if (name == "hybrid") return Exponential::hybrid;
  if (name == "power-series") return Exponential::power_series;
  if (name == "exact") return Exponential::exact;
  throw Error("exponential is \"{}\", must be optimal-linear, hybrid, power-series or exact", name);
}

namespace {

/// exp(f) = exp(f / 2^p)^(2^p).
std::vector<double> hybrid(double tau, const LinearFit& fit, std::span<const double> f, double dc) {
  int squarings = 0;
  std::vector<double> part(f.begin(), f.end());
  for (double norm = norm_without_dc(f); norm > tau && std::isfinite(norm); norm *= 0.5) ++squarings;
  for (double& value : part) value = std::ldexp(value, -squarings);
  std::vector<double> g(f.size());
  optimal_linear(fit, part.data(), int(f.size()), std::ldexp(dc, -squarings), g.data());
  for (int k = 0; k < squarings; ++k) g = sh::tensor(sh::order_of(f.size())).product(g, g);
  return g;
}

/// 1 + f (1 + f / 2 (1 + f / 3 (...))): every power of f multiplied from the left.
std::vector<double> power_series(int terms, std::span<const double> f, double dc) {
  std::vector<double> without_dc(f.begin(), f.end()), g(f.size(), 0.0);
  without_dc[0] = 0.0;
  g[0] = root_4pi;
  for (int k = terms; k >= 1; --k) {
    g = sh::tensor(sh::order_of(f.size())).product(without_dc, g);
    for (double& value : g) value /= k;
    g[0] += root_4pi;
  }
  for (double& value : g) value *= std::exp(dc);
  return g;
}

}  // namespace

std::vector<double> exponential(const Method& method, const LinearFit& fit, std::span<const double> f) {
  if (method.terms < 0) throw Error("exponential: {} terms of the power series; must be 0 or more", method.terms);
  if (!(method.tau > 0.0)) throw Error("exponential: tau is {}; must be positive", method.tau);
  const double dc = f[0] / root_4pi;
  switch (method.kind) {
    case Exponential::optimal_linear: {
      std::vector<double> g(f.size());
      optimal_linear(fit, f.data(), int(f.size()), dc, g.data());
      return g;
    }
    case Exponential::hybrid:
      return hybrid(method.tau, fit, f, dc);
    case Exponential::power_series:
      return power_series(method.terms, f, dc);
    default:
      return exact(f);
  }
}

}  // namespace penumbra::sh_exponentiation
