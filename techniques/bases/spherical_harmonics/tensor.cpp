#include "techniques/bases/spherical_harmonics/tensor.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <mutex>

#include "techniques/bases/spherical_harmonics/basis.h"

namespace penumbra::sh {

Tensor::Tensor(int order) : order_(order) {
  check_order(order);
  const Quadrature q = quadrature(3 * (order - 1));
  std::vector<std::vector<double>> y;
  y.reserve(q.weight.size());
  for (const dvec3& w : q.direction) y.push_back(evaluate(order, w));
  const int size = coefficients(order);
  std::vector<double> weighted(y.size());
  for (int i = 0; i < size; ++i)
    for (int j = i; j < size; ++j) {
      for (std::size_t p = 0; p < y.size(); ++p) weighted[p] = q.weight[p] * y[p][i] * y[p][j];
      for (int k = j; k < size; ++k) {
        // The triangle rule: other integrals vanish.
        const int a = band(i), b = band(j), c = band(k);
        if (c > a + b || (a + b + c) % 2 != 0) continue;
        double sum = 0.0;
        for (std::size_t p = 0; p < y.size(); ++p) sum += weighted[p] * y[p][k];
        if (std::abs(sum) > 1e-10) distinct_.push_back({i, j, k, sum});
      }
    }
  for (const Entry& e : distinct_) {
    std::array<int, 3> at = {e.i, e.j, e.k};  // sorted: every permutation once
    do entries_.push_back({at[0], at[1], at[2], e.value});
    while (std::next_permutation(at.begin(), at.end()));
  }
}

std::vector<double> Tensor::product(std::span<const double> f, std::span<const double> g) const {
  std::vector<double> out(f.size(), 0.0);
  for (const Entry& e : entries_) out[e.k] += e.value * f[e.i] * g[e.j];
  return out;
}

double Tensor::triple_product(std::span<const double> f, std::span<const double> g, std::span<const double> h) const {
  double sum = 0.0;
  for (const Entry& e : entries_) sum += e.value * f[e.i] * g[e.j] * h[e.k];
  return sum;
}

std::vector<double> Tensor::matrix(std::span<const double> f) const {
  const std::size_t size = f.size();
  std::vector<double> m(size * size, 0.0);
  for (const Entry& e : entries_) m[e.j * size + e.k] += e.value * f[e.i];
  return m;
}

const Tensor& tensor(int order) {
  check_order(order);
  static std::array<std::unique_ptr<Tensor>, max_order + 1> built;
  static std::mutex guard;
  const std::lock_guard lock(guard);
  if (!built[order]) built[order] = std::make_unique<Tensor>(order);
  return *built[order];
}

}  // namespace penumbra::sh
