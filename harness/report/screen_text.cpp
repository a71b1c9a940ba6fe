#include "harness/report/screen_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <sstream>

namespace penumbra {

std::string three_digits(double value) {
  if (!std::isfinite(value)) return fmt::format("{}", value);
  if (std::abs(value) >= 100.0) return fmt::format("{:.0f}", value);
  if (std::abs(value) < 1e-4) return fmt::format("{:.2g}", value);
  return fmt::format("{:.3g}", value);
}

std::string with_thousands(std::size_t value) {
  std::string text = std::to_string(value);
  for (int at = int(text.size()) - 3; at > 0; at -= 3) text.insert(std::size_t(at), ",");
  return text;
}

std::string wrapped(const std::string& text, int indent, const std::string& at_break) {
  if (columns_of(text) <= screen_columns) return unbroken(text) + "\n";
  const int room = screen_columns - columns_of(at_break);
  std::string out, line, word;
  std::istringstream words(text);
  while (words >> word) {
    if (!line.empty() && columns_of(line) + 1 + columns_of(word) > room) {
      out += line + at_break + "\n";
      line = std::string(std::size_t(indent), ' ') + word;
    } else {
      line += (line.empty() ? "" : " ") + word;
    }
  }
  return unbroken(out + line + "\n");
}

std::string unbroken(std::string text) {
  std::replace(text.begin(), text.end(), '\x1f', ' ');
  return text;
}

std::string TextTable::text() const {
  std::vector<int> widths;
  for (std::size_t c = 0; c < columns_.size(); ++c) {
    int width = 0;
    for (const auto& cells : rows_)
      if (cells.size() > 1) width = std::max(width, columns_of(cells[c]));
    widths.push_back(width == 0 ? 0 : std::min(columns_[c].most, std::max(width, columns_of(columns_[c].title))));
  }
  int before = 0;  // the last column has what the others leave
  for (const int width : widths) before += width > 0 ? 2 + width : 0;
  if (!widths.empty()) widths.back() = std::max(0, std::min(widths.back(), screen_columns - (before - widths.back())));
  const auto line_of = [&](const auto& cell) {
    std::string line;
    for (std::size_t c = 0; c < columns_.size(); ++c) {
      if (widths[c] == 0) continue;
      const std::string text = cut_to_columns(cell(c), widths[c]);
      const std::string space(std::size_t(widths[c] - columns_of(text)), ' ');
      line += "  " + (columns_[c].align == Align::left ? text + space : space + text);
    }
    line.erase(line.find_last_not_of(' ') + 1);
    return line + "\n";
  };
  std::string out = line_of([&](std::size_t c) { return columns_[c].title; });
  for (const auto& cells : rows_)
    out += cells.size() == 1 ? "  " + cells[0] + "\n" : line_of([&](std::size_t c) { return cells[c]; });
  return out;
}

}  // namespace penumbra
