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
#include <vector>

#include "techniques/bases/spherical_harmonics/basis.h"
#include "techniques/bases/spherical_harmonics/tensor.h"

namespace {

using namespace penumbra;  // NOLINT: a program of one page

std::string constant(double value) {
  return fmt::format("T({:.17g})", value);
}

/// Y_lm = z-polynomial x (x + i y)^m: one recurrence upwards in l for every m, one in m for the powers.
std::string evaluation(int order) {
  std::string text = fmt::format(
      "template <class T>\nPENUMBRA_SH_INLINE void evaluate_{}([[maybe_unused]] T x, [[maybe_unused]] T y, "
      "[[maybe_unused]] T z, T* out) {{\n",
      order);
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
      } else {
        const double a = std::sqrt((4.0 * l * l - 1.0) / (double(l) * l - double(m) * m));
        const double b = -std::sqrt((2.0 * l + 1.0) * (l + m - 1.0) * (l - m - 1.0) /
                                    ((double(l) * l - double(m) * m) * (2.0 * l - 3.0)));
        text += fmt::format("  const T {} = multiply_add({} * z, q{}_{}, {} * q{}_{});\n", q, constant(a), l - 1, m,
                            constant(b), l - 2, m);
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

/// Pairs whose Gamma has the same size for some k are summed before they are multiplied; a sum, up to its sign, is made
/// once for all k.
struct Sum {
  struct Term {
    int i, j;
    bool minus;
    auto operator<=>(const Term&) const = default;
  };
  std::vector<Term> terms;                      ///< the first is positive
  std::vector<std::pair<int, double>> adds_to;  ///< k and its factor
};

std::vector<Sum> collect_sums(int order, bool square) {
  std::map<std::pair<int, long>, std::vector<std::pair<Sum::Term, double>>> by_size;  // per k and |factor|
  for (const auto& e : sh::tensor(order).entries()) {
    if (e.i > e.j || e.i == 0 || e.k == 0) continue;
    const double factor = square && e.i != e.j ? 2.0 * e.value : e.value;
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
  for (const auto& [terms, sum] : sums) out.push_back(sum);
  return out;
}

/// Y_0 is constant, so pairs with i = 0 and sums for k = 0 share one factor, which is applied once.
std::string product(int order, bool square) {
  const int size = sh::coefficients(order);
  const double constant_factor = std::sqrt(1.0 / (4.0 * pi));
  const char* g = square ? "f" : "g";
  std::string text = fmt::format("template <class T>\nPENUMBRA_SH_INLINE void {}_{}(const T* f{}, T* out) {{\n",
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
  for (const Sum& sum : collect_sums(order, square)) {
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
  for (int order = 1; order <= sh::max_order; ++order) text += evaluation(order);
  text += dispatcher("evaluate", "T x, T y, T z, T* out", "x, y, z, out", 1, sh::max_order);
  for (int order = 2; order <= 6; ++order) text += product(order, false) + product(order, true);
  text += dispatcher("product", "const T* f, const T* g, T* out", "f, g, out", 2, 6);
  text += dispatcher("square", "const T* f, T* out", "f, out", 2, 6);
  std::ofstream out(arguments[1]);
  out << text;
  out.close();
  return out ? 0 : 1;
}
