// Named values that may be whole numbers, numbers or words: what parameters are, and what rows say of them.
#pragma once

#include <map>
#include <string>
#include <variant>

namespace penumbra {

using Value = std::variant<int, double, std::string>;
using Values = std::map<std::string, Value>;

std::string to_string(const Value& value);
std::string describe(const Values& values);  ///< "name=value name=value", sorted

}  // namespace penumbra
