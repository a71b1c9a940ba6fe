#include "scenes/values.h"

#include <fmt/format.h>

namespace penumbra {

std::string to_string(const Value& value) {
  return std::visit([](const auto& v) { return fmt::format("{}", v); }, value);
}

std::string describe(const Values& values) {
  std::string text;
  for (const auto& [name, value] : values) text += (text.empty() ? "" : " ") + name + "=" + to_string(value);
  return text;
}

}  // namespace penumbra
