// Products of functions in the basis: (f * g)_k = sum of Gamma_ijk f_i g_j, Gamma_ijk the integral of Y_i Y_j Y_k,
// truncated to the order of f and g (Ren et al. 2006; Snyder 2006).
#pragma once

#include <span>
#include <vector>

namespace penumbra::sh {

/// Gamma of one order, its nonzero entries only. Symmetric in all three indices.
class Tensor {
 public:
  struct Entry {
    int i, j, k;
    double value;
  };
  explicit Tensor(int order);

  int order() const { return order_; }
  /// All with i <= j <= k, in that order.
  const std::vector<Entry>& distinct() const { return distinct_; }
  /// All index triples: the sum over these is the product.
  const std::vector<Entry>& entries() const { return entries_; }

  std::vector<double> product(std::span<const double> f, std::span<const double> g) const;
  /// Integral of f g h: the product's dot product with h, in any order.
  double triple_product(std::span<const double> f, std::span<const double> g, std::span<const double> h) const;
  /// (M_f)_jk = sum over i of Gamma_ijk f_i, row by row: multiplication by f.
  std::vector<double> matrix(std::span<const double> f) const;

 private:
  int order_;
  std::vector<Entry> distinct_, entries_;
};

/// The tensor of an order, built once.
const Tensor& tensor(int order);

}  // namespace penumbra::sh
