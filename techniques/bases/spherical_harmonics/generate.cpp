// Writes straight_line.inc: evaluation and products without loops or tables, for each order on its own (after Sloan
// 2013 and Snyder 2006). The text is included inside a namespace, once for plain floats and once per instruction set;
// there T is a number or a vector of numbers, with +, -, *, construction from a double, and multiply_add(a, b, c) = a b
// + c.
#include <fmt/format.h>

#include <cmath>
#include <fstream>
#include <iostream>
#include <map>
#include <set>
#include <tuple>
#include <vector>

#include "techniques/bases/spherical_harmonics/basis.h"
#include "techniques/bases/spherical_harmonics/tensor.h"

namespace {

using namespace penumbra;  // NOLINT: a program of one page

std::string constant(double value) {
  return fmt::format("T({:.17g})", value);
}

/// Y_lm = upwards z Y_{l-1,m} + upwards_2 Y_{l-2,m}.
double upwards(int l, int m) {
  return std::sqrt((4.0 * l * l - 1.0) / (double(l) * l - double(m) * m));
}
double upwards_2(int l, int m) {
  return -std::sqrt((2.0 * l + 1.0) * (l + m - 1.0) * (l - m - 1.0) /
                    ((double(l) * l - double(m) * m) * (2.0 * l - 3.0)));
}

/// Y_lm = z-polynomial x (x + i y)^m: one recurrence upwards in l for every m, one in m for the powers.
std::string evaluation(int order) {
  std::string text = fmt::format(
      "template <class T>\nPENUMBRA_SH_INLINE void evaluate_{}([[maybe_unused]] T x, [[maybe_unused]] T y, "
      "[[maybe_unused]] T z, T* out) {{\n",
      order);
  text += "  [[maybe_unused]] const T z2 = z * z;\n";
  double diagonal = std::sqrt(1.0 / (4.0 * pi));  // Y_mm over (x + i y)^m, with Condon-Shortley phase
  for (int m = 0; m < order; ++m) {
    if (m == 1) text += "  const T c1 = x, s1 = y;\n";
    if (m > 1)
      text += fmt::format("  const T c{0} = x * c{1} - y * s{1}, s{0} = multiply_add(x, s{1}, y * c{1});\n", m, m - 1);
    if (m > 0) diagonal *= -std::sqrt((2.0 * m + 1.0) / (2.0 * m));
    const double scale = m == 0 ? 1.0 : std::sqrt(2.0);
    for (int l = m; l < order; ++l) {
      const std::string q = fmt::format("q{}_{}", l, m);
      if (l == m) {
        text += fmt::format("  const T {} = {};\n", q, constant(scale * diagonal));
      } else if (l == m + 1) {
        text += fmt::format("  const T {} = {} * z;\n", q, constant(scale * diagonal * std::sqrt(2.0 * m + 3.0)));
      } else if (l == m + 2) {
        const double scale_1 = scale * diagonal * std::sqrt(2.0 * m + 3.0);
        text += fmt::format("  const T {} = multiply_add({}, z2, {});\n", q, constant(upwards(l, m) * scale_1),
                            constant(upwards_2(l, m) * scale * diagonal));
      } else {
        text += fmt::format("  const T {} = multiply_add({} * z, q{}_{}, {} * q{}_{});\n", q, constant(upwards(l, m)),
                            l - 1, m, constant(upwards_2(l, m)), l - 2, m);
      }
      if (m == 0) {
        text += fmt::format("  out[{}] = {};\n", sh::index(l, 0), q);
      } else {
        text += fmt::format("  out[{}] = {} * c{};\n  out[{}] = {} * s{};\n", sh::index(l, m), q, m, sh::index(l, -m),
                            q, m);
      }
    }
  }
  return text + "}\n\n";
}

/// sqrt(4 pi / (2 l + 1)) z_l Y_lm(axis).
std::string zonal_rotation(int order) {
  std::string text = fmt::format(
      "template <class T>\nPENUMBRA_SH_INLINE void rotate_zonal_{0}(const T* zonal, T x, T y, T z, T* out) {{\n"
      "  evaluate_{0}(x, y, z, out);\n",
      order);
  for (int l = 0; l < order; ++l) {
    text += fmt::format("  const T b{0} = {1} * zonal[{0}];\n", l, constant(std::sqrt(4.0 * pi / (2.0 * l + 1.0))));
    for (int i = sh::index(l, -l); i <= sh::index(l, l); ++i)
      text += fmt::format("  out[{0}] = b{1} * out[{0}];\n", i, l);
  }
  return text + "}\n\n";
}

/// Pairs whose Gamma has the same size for some k are summed before they are multiplied; a sum, up to its sign, is made
/// once for all k.
struct Sum {
  struct Term {
    int i, j;
    bool minus;
    bool operator<(const Term& other) const { return std::tie(i, j, minus) < std::tie(other.i, other.j, other.minus); }
  };
  std::vector<Term> terms;                      ///< the first is positive
  std::vector<std::pair<int, double>> adds_to;  ///< k and its factor
};

/// `equal`: what Gamma_iik is multiplied by, `unequal` the others.
std::vector<Sum> collect_sums(int order, double equal = 1.0, double unequal = 1.0) {
  std::map<std::pair<int, long>, std::vector<std::pair<Sum::Term, double>>> by_size;  // per k and |factor|
  for (const auto& e : sh::tensor(order).entries()) {
    if (e.i > e.j || e.i == 0 || e.k == 0) continue;
    const double factor = (e.i == e.j ? equal : unequal) * e.value;
    by_size[{e.k, std::lround(std::abs(factor) * 1e9)}].push_back({{e.i, e.j, factor < 0.0}, factor});
  }
  std::map<std::vector<Sum::Term>, Sum> sums;
  for (const auto& [key, members] : by_size) {
    const bool flip = members[0].first.minus;
    std::vector<Sum::Term> terms;
    for (const auto& [term, factor] : members) terms.push_back({term.i, term.j, term.minus != flip});
    Sum& sum = sums[terms];
    sum.terms = terms;
    sum.adds_to.emplace_back(key.first, members[0].second);
  }
  std::vector<Sum> out;
  out.reserve(sums.size());
  for (const auto& [terms, sum] : sums) out.push_back(sum);
  return out;
}

/// Y_0 is constant, so pairs with i = 0 and sums for k = 0 share one factor, which is applied once.
std::string product(int order, bool square) {
  const int size = sh::coefficients(order);
  const double constant_factor = std::sqrt(1.0 / (4.0 * pi));
  const char* g = square ? "f" : "g";
  std::string text = fmt::format("template <class T>\nPENUMBRA_SH_PRODUCT void {}_{}(const T* f{}, T* out) {{\n",
                                 square ? "square" : "product", order, square ? "" : ", const T* g");
  text += fmt::format("  const T f0 = {} * f[0];\n", constant(square ? 2.0 * constant_factor : constant_factor));
  if (!square) text += fmt::format("  const T g0 = {} * g[0];\n", constant(constant_factor));
  text += fmt::format("  T r0 = f[0] * {}[0];\n", g);
  for (int i = 1; i < size; ++i)
    text += square ? fmt::format("  T r{0} = f0 * f[{0}];\n", i)
                   : fmt::format("  T r{0} = multiply_add(f0, g[{0}], f[{0}] * g0);\n", i);
  std::set<std::pair<int, int>> made;
  const auto make = [&](int i, int j) {
    if (!made.insert({i, j}).second) return;
    text += square || i == j
                ? fmt::format("  const T t{0}_{1} = f[{0}] * {2}[{1}];\n", i, j, g)
                : fmt::format("  const T t{0}_{1} = multiply_add(f[{0}], g[{1}], f[{1}] * g[{0}]);\n", i, j);
    if (i == j) text += fmt::format("  r0 = r0 + t{0}_{0};\n", i);
  };
  for (int i = 1; i < size; ++i) make(i, i);
  int number = 0;
  for (const Sum& sum : collect_sums(order, 1.0, square ? 2.0 : 1.0)) {
    for (const auto& term : sum.terms) make(term.i, term.j);
    std::string value;
    for (const auto& term : sum.terms)
      value += fmt::format("{}t{}_{}", value.empty() ? "" : term.minus ? " - " : " + ", term.i, term.j);
    text += fmt::format("  const T s{} = {};\n", number, value);
    for (const auto& [k, factor] : sum.adds_to)
      text += fmt::format("  r{0} = multiply_add({1}, s{2}, r{0});\n", k, constant(factor), number);
    ++number;
  }
  text += fmt::format("  out[0] = {} * r0;\n", constant(constant_factor));
  for (int i = 1; i < size; ++i) text += fmt::format("  out[{0}] = r{0};\n", i);
  return text + "}\n\n";
}

/// out_k += sum of Gamma_ijk t_ij over i <= j, i > 0, k > 0, where t[i * stride + j] = f_i g_j + f_j g_i, also for i =
/// j.
std::string contraction(int order) {
  const int size = sh::coefficients(order);
  std::string text = fmt::format(
      "template <int stride, class T>\nPENUMBRA_SH_PRODUCT void contract_{}([[maybe_unused]] const T* t, T* out) {{\n",
      order);
  for (int k = 1; k < size; ++k) text += fmt::format("  T r{0} = out[{0}];\n", k);
  text += "  [[maybe_unused]] T s;\n";
  for (const Sum& sum : collect_sums(order, 0.5)) {
    std::string value;
    for (const auto& term : sum.terms)
      value += fmt::format("{}t[{} * stride + {}]", value.empty() ? "" : term.minus ? " - " : " + ", term.i, term.j);
    text += fmt::format("  s = {};\n", value);
    for (const auto& [k, factor] : sum.adds_to)
      text += fmt::format("  r{0} = multiply_add({1}, s, r{0});\n", k, constant(factor));
  }
  for (int k = 1; k < size; ++k) text += fmt::format("  out[{0}] = r{0};\n", k);
  return text + "}\n\n";
}

std::string dispatcher(const char* name, const char* parameters, const char* arguments, int low, int high) {
  std::string text = fmt::format(
      "template <int order, class T>\nPENUMBRA_SH_INLINE void {}({}) {{\n"
      "  static_assert(order >= {} && order <= {});\n",
      name, parameters, low, high);
  for (int order = low; order <= high; ++order)
    text += fmt::format("  if constexpr (order == {0}) {1}_{0}({2});\n", order, name, arguments);
  return text + "}\n\n";
}

}  // namespace

int main(int count, char** arguments) {
  if (count != 2) {
    std::cerr << "usage: generate_spherical_harmonics FILE\n";
    return 2;
  }
  std::string text = "// Written by techniques/bases/spherical_harmonics/generate.cpp.\n\n";
  for (int order = 1; order <= sh::max_order; ++order) text += evaluation(order) + zonal_rotation(order);
  text += dispatcher("evaluate", "T x, T y, T z, T* out", "x, y, z, out", 1, sh::max_order);
  text += dispatcher("rotate_zonal", "const T* zonal, T x, T y, T z, T* out", "zonal, x, y, z, out", 1, sh::max_order);
  for (int order = 2; order <= 6; ++order) text += product(order, false) + product(order, true) + contraction(order);
  text += dispatcher("product", "const T* f, const T* g, T* out", "f, g, out", 2, 6);
  text += dispatcher("square", "const T* f, T* out", "f, out", 2, 6);
  text += "template <int order, int stride, class T>\nPENUMBRA_SH_INLINE void contract(const T* t, T* out) {\n";
  for (int order = 2; order <= 6; ++order)
    text += fmt::format("  if constexpr (order == {0}) contract_{0}<stride>(t, out);\n", order);
  text += "}\n";
  std::ofstream out(arguments[1]);
  out << text;
  out.close();
  return out ? 0 : 1;
}
