// Text for a terminal: at most 100 columns, whatever is in it.
#pragma once

#include <string>
#include <vector>

#include "harness/results/text.h"

namespace penumbra {

inline constexpr int screen_columns = 100;

/// Three significant digits, and no power of ten: "0.0571", "5.7", "1234".
std::string three_digits(double value);
/// "16,384".
std::string with_thousands(std::size_t value);

/// Broken at spaces into lines that fit the screen, all but the first indented; ends with a newline. `at_break` ends
/// the lines that go on (" \\" in a command). A word that is longer than the screen stays whole; '\x1f' becomes a space
/// at which no line is broken.
std::string wrapped(const std::string& text, int indent, const std::string& at_break = "");

/// With spaces in place of '\x1f'.
std::string unbroken(std::string text);

enum class Align { left, right };
struct Column {
  std::string title;
  int most;  ///< columns; what is longer is cut
  Align align;
};

/// Rows in columns as wide as they need to be; columns that are empty throughout are left out.
class TextTable {
 public:
  explicit TextTable(std::vector<Column> columns) : columns_(std::move(columns)) {}
  void row(std::vector<std::string> cells) { rows_.push_back(std::move(cells)); }
  /// Across all columns.
  void line(std::string text) { rows_.push_back({std::move(text)}); }
  std::string text() const;

 private:
  std::vector<Column> columns_;
  std::vector<std::vector<std::string>> rows_;  ///< of one cell: across all columns
};

}  // namespace penumbra
