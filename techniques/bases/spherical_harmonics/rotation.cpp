#include "techniques/bases/spherical_harmonics/rotation.h"

#include <cmath>
#include <utility>

#include "scenes/error.h"
#include "techniques/bases/spherical_harmonics/basis.h"
#include "techniques/bases/spherical_harmonics/straight_line.h"

namespace penumbra::sh {
namespace {

/// Entries of the bands below l.
constexpr int first_entry(int l) {
  return l * (2 * l - 1) * (2 * l + 1) / 3;
}

/// The factors u, v, w of entry (m, n) of band l; they do not depend on the rotation.
struct Factors {
  double u, v, w;
};

Factors factors_of(int l, int m, int n) {
  const int a = std::abs(m);
  const double below = std::abs(n) == l ? 2.0 * l * (2.0 * l - 1.0) : double(l + n) * double(l - n);
  const double alone = m == 0 ? 1.0 : 0.0;
  return {std::sqrt(double(l + m) * double(l - m) / below),
          0.5 * std::sqrt((1.0 + alone) * double(l + a - 1) * double(l + a) / below) * (1.0 - 2.0 * alone),
          -0.5 * std::sqrt(double(l - a - 1) * double(l - a) / below) * (1.0 - alone)};
}

const std::vector<Factors>& all_factors() {
  static const std::vector<Factors> all = [] {
    std::vector<Factors> list(std::size_t(first_entry(2)));  // the recurrence begins with band 2
    list.reserve(std::size_t(first_entry(max_order)));
    for (int l = 2; l < max_order; ++l)
      for (int m = -l; m <= l; ++m)
        for (int n = -l; n <= l; ++n) list.push_back(factors_of(l, m, n));
    return list;
  }();
  return all;
}

/// One band of the matrices, for functions without the Condon-Shortley phase.
struct Band {
  const double* entry;
  int l;
  double operator()(int m, int n) const { return entry[(m + l) * (2 * l + 1) + n + l]; }
};

/// The sums P of the recurrence for column n: products of a row of band 1 with an entry of the band before.
double p(const Band& first, const Band& before, int i, int a, int n) {
  const int l = before.l + 1;
  if (n == -l) return first(i, 1) * before(a, -l + 1) + first(i, -1) * before(a, l - 1);
  if (n == l) return first(i, 1) * before(a, l - 1) - first(i, -1) * before(a, -l + 1);
  return first(i, 0) * before(a, n);
}

double entry_of(const Band& first, const Band& before, const Factors& factors, int m, int n) {
  const int l = before.l + 1;
  const auto term = [&](int i, int a) { return p(first, before, i, a, n); };
  const double u = std::abs(m) < l ? factors.u * term(0, m) : 0.0;
  double v = 0.0, w = 0.0;
  if (m == 0) v = term(1, 1) + term(-1, -1);
  else if (m == 1) v = std::sqrt(2.0) * term(1, 0);
  else if (m == -1) v = std::sqrt(2.0) * term(-1, 0);
  else if (m > 0) v = term(1, m - 1) - term(-1, -m + 1);
  else v = term(1, m + 1) + term(-1, -m - 1);
  if (m > 0 && m < l - 1) w = term(1, m + 1) + term(-1, -m - 1);
  if (m < 0 && -m < l - 1) w = term(1, m - 1) - term(-1, -m + 1);
  return u + factors.v * v + factors.w * w;
}

void check_orthogonal(const glm::dmat3& turn) {
  const glm::dmat3 unit = turn * glm::transpose(turn);
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k < 3; ++k)
      if (!(std::abs(unit[i][k] - (i == k ? 1.0 : 0.0)) < 1e-6))
        throw Error("spherical harmonics: the rotation matrix is not orthogonal");
}

}  // namespace

Rotation::Rotation(int order, const glm::dmat3& turn) : order_(order) {
  check_order(order);
  check_orthogonal(turn);
  entries_.resize(std::size_t(first_entry(order)));
  entries_[0] = 1.0;
  constexpr int axis[3] = {1, 2, 0};  // band 1 is y, z, x
  std::size_t entry = 1;
  for (int m = 0; m < 3 && order > 1; ++m)
    for (int n = 0; n < 3; ++n) entries_[entry++] = turn[axis[n]][axis[m]];
  const Factors* factors = all_factors().data();
  for (int l = 2; l < order; ++l) {
    const Band first{&entries_[1], 1}, before{&entries_[std::size_t(first_entry(l - 1))], l - 1};
    for (int m = -l, k = first_entry(l); m <= l; ++m)
      for (int n = -l; n <= l; ++n, ++k) entries_[std::size_t(k)] = entry_of(first, before, factors[k], m, n);
  }
  // The phase turns the sign of the functions of odd m.
  for (int l = 1; l < order; ++l)
    for (int m = -l, k = first_entry(l); m <= l; ++m)
      for (int n = -l; n <= l; ++n, ++k)
        if ((m + n) % 2 != 0) entries_[std::size_t(k)] = -entries_[std::size_t(k)];
  narrow_.assign(entries_.begin(), entries_.end());
}

namespace {

/// One band of out = R c; the sums' lengths are known to the compiler.
template <int l, class T>
void rotate_band(const T* entries, const T* c, T* out) {
  constexpr int size = 2 * l + 1;
  for (int i = 0; i < size; ++i) {
    T sum = entries[first_entry(l) + i * size] * c[l * l];
    for (int j = 1; j < size; ++j) sum += entries[first_entry(l) + i * size + j] * c[l * l + j];
    out[l * l + i] = sum;
  }
}

template <class T>
void rotate(int order, const T* entries, const T* c, T* out) {
  with_order<1, max_order>(order, [&](auto n) {
    [&]<int... l>(std::integer_sequence<int, l...>) {
      (rotate_band<l>(entries, c, out), ...);
    }
    (std::make_integer_sequence<int, n>());
  });
}

}  // namespace

std::vector<double> Rotation::operator()(std::span<const double> c) const {
  if (c.size() != std::size_t(coefficients(order_)))
    throw Error("spherical harmonics: {} coefficients given to a rotation of order {}", c.size(), order_);
  std::vector<double> out(c.size());
  rotate(order_, entries_.data(), c.data(), out.data());
  return out;
}

void Rotation::operator()(const float* c, float* out) const {
  rotate(order_, narrow_.data(), c, out);
}

}  // namespace penumbra::sh
