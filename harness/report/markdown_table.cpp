#include "harness/report/markdown_table.h"

#include <algorithm>
#include <cassert>

namespace penumbra {
namespace {

std::string escaped(const std::string& cell) {
  std::string text;
  for (const char c : cell)
    if (c == '\n') text += ' ';
    else text += c == '|' ? std::string("\\|") : std::string(1, c);
  return text;
}

}  // namespace

void MarkdownTable::add(std::vector<std::string> cells) {
  assert(cells.size() == columns_.size());
  std::transform(cells.begin(), cells.end(), cells.begin(), escaped);
  lines_.push_back(std::move(cells));
}

std::string MarkdownTable::text() const {
  if (lines_.empty()) return "";
  std::vector<std::size_t> shown;
  for (std::size_t k = 0; k < columns_.size(); ++k)
    if (std::any_of(lines_.begin(), lines_.end(), [&](const auto& line) { return !line[k].empty(); }))
      shown.push_back(k);
  const auto line_of = [&](const std::vector<std::string>& cells) {
    std::string line = "|";
    for (const std::size_t k : shown) line += " " + cells[k] + (cells[k].empty() ? "|" : " |");
    return line + "\n";
  };
  std::string text = line_of(columns_) + "|";
  for (std::size_t k = 0; k < shown.size(); ++k) text += "---|";
  text += "\n";
  for (const auto& line : lines_) text += line_of(line);
  return text;
}

}  // namespace penumbra
