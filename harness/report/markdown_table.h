// Markdown tables that leave out what says nothing.
#pragma once

#include <string>
#include <vector>

namespace penumbra {

class MarkdownTable {
 public:
  explicit MarkdownTable(std::vector<std::string> columns) : columns_(std::move(columns)) {}
  /// One cell for every column. A '|' or a line break in a cell is written so that it stays there.
  void add(std::vector<std::string> cells);
  bool empty() const { return lines_.empty(); }
  /// Without the columns in which every cell is empty; "" if there is no line at all.
  std::string text() const;

 private:
  std::vector<std::string> columns_;
  std::vector<std::vector<std::string>> lines_;
};

}  // namespace penumbra
