// Regular expressions, compiled in one place: <regex> costs every source that sees it seconds of compilation.
#pragma once

#include <memory>
#include <string>
#include <vector>

namespace penumbra {

/// A regular expression in ECMAScript's grammar.
class Pattern {
 public:
  /// Throws Error "WHAT '(' is not a regular expression: why".
  Pattern(const std::string& what, const std::string& expression);

  bool is_in(const std::string& text) const;
  /// If it matches the whole text: that text, then what each pair of parentheses matched. Else empty.
  std::vector<std::string> parts_of(const std::string& text) const;

 private:
  struct Compiled;
  std::shared_ptr<const Compiled> compiled_;
};

}  // namespace penumbra
