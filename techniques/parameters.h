// Parameters of a technique: declared with unit, default, range and meaning; checked when given.
#pragma once

#include <string>
#include <vector>

#include "scenes/values.h"

namespace penumbra {

using ParameterValue = Value;

/// What a technique accepts under one name.
struct Parameter {
  std::string name, unit, meaning;
  ParameterValue fallback;                   ///< the default; its type is the parameter's type
  double low = 0.0, high = 0.0;              ///< numbers: inclusive range
  std::vector<ParameterValue> allowed = {};  ///< if not empty, one of these

  std::string range() const;  ///< for messages and listings
};

Parameter integer_parameter(std::string name, int fallback, int low, int high, std::string unit, std::string meaning);
Parameter number_parameter(std::string name, double fallback, double low, double high, std::string unit,
                           std::string meaning);
Parameter choice_parameter(std::string name, std::vector<ParameterValue> allowed, std::string meaning);

/// Values by name. After resolve() every declared parameter has one.
class Parameters {
 public:
  void set(const std::string& name, ParameterValue value) { values_[name] = std::move(value); }
  int integer(const std::string& name) const { return std::get<int>(values_.at(name)); }
  double number(const std::string& name) const { return std::get<double>(values_.at(name)); }
  const std::string& text(const std::string& name) const { return std::get<std::string>(values_.at(name)); }
  const Values& all() const { return values_; }
  std::string describe() const { return penumbra::describe(values_); }

  /// Checks the given values against the declaration and fills in defaults.
  /// Throws Error naming the parameter, `owner` and what is allowed.
  Parameters resolve(const std::vector<Parameter>& declared, const std::string& owner) const;

 private:
  Values values_;
};

/// Parses "name=value" texts; numbers become int or double, everything else stays text.
Parameters parse_parameters(const std::vector<std::string>& assignments);

}  // namespace penumbra
