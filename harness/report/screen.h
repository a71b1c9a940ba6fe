// Text for a screen: how wide that is, and lines that fit it.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace penumbra {

/// Columns of the terminal behind a file descriptor: $COLUMNS, else what the terminal says. Empty where neither is
/// known, as in a pipe.
std::optional<int> terminal_width(int descriptor);

/// Columns that stdout's screens keep to: those of the terminal, at least 40 and at most 100; 100 if not known.
int screen_width();

/// `text` broken at spaces so that no line exceeds `width` columns, unless one word does. Line breaks in it are kept.
/// Lines after the first begin with `indent` spaces, the first one stands behind `start` columns of something else. No
/// line break at the end.
std::string wrapped(const std::string& text, int width, int indent = 0, int start = 0);

/// "  label   text": the text begins at `column` and is wrapped there; after a longer label it begins on a line of its
/// own. Ends with a line break.
std::string labelled(const std::string& label, const std::string& text, int column, int width);

/// A row's label with spaces for its slashes, so that it can be broken into lines.
std::string spaced(std::string label);

/// A command that is broken in the shell's way (" \\") before a word, and never at '\x1f', which becomes a space; all
/// lines but the first begin with four spaces. No line break at the end.
std::string wrapped_command(const std::string& command, int width);
/// A command on one line, with spaces in place of '\x1f'.
std::string unbroken(std::string command);

/// A number as "16,384".
std::string with_thousands(std::size_t value);

enum class Align { left, right };
struct Column {
  std::string title;
  int most;  ///< columns; what is longer is cut
  Align align;
};

/// Rows in columns as wide as they need to be; those that are empty throughout are left out, and the last one has what
/// the others leave of the width.
class TextTable {
 public:
  TextTable(std::vector<Column> columns, int width) : columns_(std::move(columns)), width_(width) {}
  void row(std::vector<std::string> cells) { rows_.push_back(std::move(cells)); }
  /// Adds a text across all columns.
  void line(std::string text) { rows_.push_back({std::move(text)}); }
  std::string text() const;

 private:
  std::vector<int> widths() const;

  std::vector<Column> columns_;
  int width_;
  std::vector<std::vector<std::string>> rows_;  ///< of one cell: across all columns
};

}  // namespace penumbra
