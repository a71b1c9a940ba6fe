#include "scenes/pattern.h"

#include <regex>

#include "scenes/error.h"

namespace penumbra {

struct Pattern::Compiled {
  std::regex regex;
};

Pattern::Pattern(const std::string& what, const std::string& expression) {
  try {
    compiled_ = std::make_shared<const Compiled>(Compiled{std::regex(expression)});
  } catch (const std::regex_error& e) {
    throw Error("{} '{}' is not a regular expression: {}", what, expression, e.what());
  }
}

bool Pattern::is_in(const std::string& text) const {
  return std::regex_search(text, compiled_->regex);
}

std::vector<std::string> Pattern::parts_of(const std::string& text) const {
  std::smatch parts;
  if (!std::regex_match(text, parts, compiled_->regex)) return {};
  return {parts.begin(), parts.end()};
}

}  // namespace penumbra
