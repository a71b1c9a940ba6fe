#include "techniques/parameters.h"

#include <algorithm>
#include <charconv>

#include <fmt/ranges.h>

#include "scenes/error.h"

namespace penumbra {

std::string Parameter::range() const {
  if (allowed.empty()) return fmt::format("[{}, {}]", low, high);
  std::vector<std::string> names;
  for (const auto& value : allowed) names.push_back(to_string(value));
  return fmt::format("{}", fmt::join(names, ", "));
}

Parameter integer_parameter(std::string name, int fallback, int low, int high, std::string unit, std::string meaning) {
  return {std::move(name), std::move(unit), std::move(meaning), fallback, double(low), double(high)};
}

Parameter number_parameter(std::string name, double fallback, double low, double high, std::string unit,
                           std::string meaning) {
  return {std::move(name), std::move(unit), std::move(meaning), fallback, low, high};
}

Parameter choice_parameter(std::string name, std::vector<ParameterValue> allowed, std::string meaning) {
  ParameterValue first = allowed.at(0);
  return {std::move(name), "", std::move(meaning), std::move(first), 0.0, 0.0, std::move(allowed)};
}

namespace {

ParameterValue checked(const Parameter& declared, ParameterValue value, const std::string& owner) {
  if (std::holds_alternative<double>(declared.fallback) && std::holds_alternative<int>(value))
    value = double(std::get<int>(value));
  bool good = value.index() == declared.fallback.index();
  if (good && !declared.allowed.empty())
    good = std::find(declared.allowed.begin(), declared.allowed.end(), value) != declared.allowed.end();
  else if (good && std::holds_alternative<int>(value))
    good = std::get<int>(value) >= declared.low && std::get<int>(value) <= declared.high;
  else if (good && std::holds_alternative<double>(value))
    good = std::get<double>(value) >= declared.low && std::get<double>(value) <= declared.high;
  if (!good)
    throw Error("parameter '{}' of {} is {}; allowed is {}", declared.name, owner, to_string(value), declared.range());
  return value;
}

}  // namespace

Parameters Parameters::resolve(const std::vector<Parameter>& declared, const std::string& owner) const {
  Parameters out;
  std::vector<std::string> names;
  for (const Parameter& p : declared) {
    names.push_back(p.name);
    const auto given = values_.find(p.name);
    out.set(p.name, given == values_.end() ? p.fallback : checked(p, given->second, owner));
  }
  for (const auto& [name, value] : values_)
    if (std::find(names.begin(), names.end(), name) == names.end())
      throw Error("{} has no parameter '{}'; it has: {}", owner, name,
                  names.empty() ? "none" : fmt::format("{}", fmt::join(names, ", ")));
  return out;
}

Parameters parse_parameters(const std::vector<std::string>& assignments) {
  Parameters out;
  for (const std::string& text : assignments) {
    const auto equals = text.find('=');
    if (equals == std::string::npos || equals == 0) throw Error("'{}' is not of the form name=value", text);
    const std::string name = text.substr(0, equals), value = text.substr(equals + 1);
    const char *begin = value.data(), *end = begin + value.size();
    int whole;
    double number;
    if (auto r = std::from_chars(begin, end, whole); r.ec == std::errc() && r.ptr == end) out.set(name, whole);
    else if (auto d = std::from_chars(begin, end, number); d.ec == std::errc() && d.ptr == end) out.set(name, number);
    else out.set(name, value);
  }
  return out;
}

}  // namespace penumbra
