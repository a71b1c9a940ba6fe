#include "techniques/bases/spherical_harmonics/lobes.h"

#include <cmath>

#include "scenes/error.h"
#include "techniques/bases/spherical_harmonics/basis.h"

namespace penumbra::sh {

Zonal cosine_lobe(int order) {
  check_order(order);
  Zonal a = {std::sqrt(pi) / 2.0, std::sqrt(pi / 3.0)};
  a.resize(std::size_t(order), 0.0);
  double central = 1.0;  // l! / (2^l ((l/2)!)^2)
  for (int l = 2; l < order; l += 2) {
    central *= (l - 1.0) / l;
    const double sign = l / 2 % 2 == 1 ? 1.0 : -1.0;
    a[l] = 2.0 * pi * std::sqrt((2.0 * l + 1.0) / (4.0 * pi)) * sign * central / ((l + 2.0) * (l - 1.0));
  }
  return a;
}

Zonal cap_visibility(int order, double theta) {
  check_order(order);
  const double x = std::cos(theta);
  Zonal v = {std::sqrt(pi) * (1.0 + x)};
  for (int l = 1; l < order; ++l)
    v.push_back(-std::sqrt(pi / (2.0 * l + 1.0)) * (legendre(l - 1, x) - legendre(l + 1, x)));
  return v;
}

std::vector<double> rotate_zonal(const Zonal& zonal, dvec3 axis) {
  std::vector<double> c = evaluate(int(zonal.size()), axis);
  for (std::size_t i = 0; i < c.size(); ++i) {
    const int l = band(int(i));
    c[i] *= std::sqrt(4.0 * pi / (2.0 * l + 1.0)) * zonal[l];
  }
  return c;
}

Window parse_window(const std::string& name) {
  if (name == "none") return Window::none;
  if (name == "hann") return Window::hann;
  if (name == "lanczos") return Window::lanczos;
  if (name == "laplacian") return Window::laplacian;
  throw Error("spherical harmonics: window is \"{}\", must be none, hann, lanczos or laplacian", name);
}

std::vector<double> window(Window kind, int order, double lambda) {
  check_order(order);
  std::vector<double> factors;
  for (int l = 0; l < order; ++l) {
    const double t = pi * l / order, edge = lambda * l * l * (l + 1.0) * (l + 1.0);
    switch (kind) {
      case Window::none:
        factors.push_back(1.0);
        break;
      case Window::hann:
        factors.push_back(0.5 * (1.0 + std::cos(t)));
        break;
      case Window::lanczos:
        factors.push_back(l == 0 ? 1.0 : std::sin(t) / t);
        break;
      case Window::laplacian:
        factors.push_back(1.0 / (1.0 + edge));
        break;
    }
  }
  return factors;
}

void apply_window(std::span<const double> factors, std::span<double> c) {
  for (std::size_t i = 0; i < c.size(); ++i) c[i] *= factors[band(int(i))];
}

}  // namespace penumbra::sh
