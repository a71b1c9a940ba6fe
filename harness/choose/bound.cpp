#include "harness/choose/bound.h"

#include <charconv>
#include <cmath>
#include <optional>
#include <utility>

#include "scenes/error.h"

namespace penumbra {
namespace {

/// A number and its unit, which may stand apart.
std::optional<std::pair<double, std::string>> number_and_unit(const std::string& text) {
  double number = 0.0;
  const char *first = text.data(), *last = first + text.size();
  const auto [end, fault] = std::from_chars(first, last, number);
  if (fault != std::errc() || !std::isfinite(number)) return {};
  std::string unit(end, last);
  unit.erase(0, unit.find_first_not_of(' '));
  return std::pair{number, unit};
}

}  // namespace

std::string Bound::text() const {
  return kind == Kind::error ? fmt::format("{:.3g} %", 100.0 * value) : fmt::format("{:.3g} ms", value);
}

Bound parse_error_bound(const std::string& text) {
  const auto parsed = number_and_unit(text);
  const double value = !parsed                  ? -1.0
                       : parsed->second == "%"  ? 0.01 * parsed->first
                       : parsed->second.empty() ? parsed->first
                                                : -1.0;
  if (value < 0.001 || value > 1.0)
    throw Error("--error {}: allowed is 0.1% to 100% (or 0.001 to 1) of relative RMSE, such as 2%", text);
  return {Bound::Kind::error, value};
}

Bound parse_time_bound(const std::string& text) {
  const auto parsed = number_and_unit(text);
  double ms = -1.0;
  for (const auto& [unit, factor] : {std::pair{"us", 1e-3}, {"ms", 1.0}, {"s", 1e3}})
    if (parsed && parsed->second == unit) ms = factor * parsed->first;
  if (!(ms >= 1e-3 && ms <= 3.6e6))
    throw Error("--budget {}: allowed is a time of a frame from 1us to 3600s with its unit (us, ms, s), such as 10ms",
                text);
  return {Bound::Kind::time, ms};
}

}  // namespace penumbra
