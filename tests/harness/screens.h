// What a terminal of so many columns would make of a text.
#pragma once

#include <algorithm>
#include <sstream>
#include <string>

#include "harness/report/screen_text.h"

namespace penumbra::test {

/// The lines that do not fit; empty if all do.
inline std::string lines_too_long(const std::string& text, int columns) {
  std::istringstream lines(text);
  std::string line, out;
  while (std::getline(lines, line))
    if (columns_of(line) > columns) out += line + "\n";
  return out;
}

inline int count_lines(const std::string& text) {
  return int(std::count(text.begin(), text.end(), '\n'));
}

}  // namespace penumbra::test
