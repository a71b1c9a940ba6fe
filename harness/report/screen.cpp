#include "harness/report/screen.h"

#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <sstream>

#include "harness/results/text.h"

namespace penumbra {
namespace {

constexpr int narrowest = 40, widest = 100;

}  // namespace

std::optional<int> terminal_width(int descriptor) {
  if (const char* columns = std::getenv("COLUMNS"))
    if (const int n = std::atoi(columns); n > 0) return n;
  winsize size{};
  if (isatty(descriptor) && ioctl(descriptor, TIOCGWINSZ, &size) == 0 && size.ws_col > 0) return size.ws_col;
  return {};
}

int screen_width() {
  return std::clamp(terminal_width(STDOUT_FILENO).value_or(widest), narrowest, widest);
}

std::string wrapped(const std::string& text, int width, int indent, int start) {
  const std::string margin = "\n" + std::string(std::size_t(std::max(indent, 0)), ' ');
  std::string out;
  std::istringstream lines(text);
  int at = start;
  for (std::string line; std::getline(lines, line);) {
    if (!out.empty()) out += margin, at = indent;
    std::istringstream words(line);
    bool first = true;
    for (std::string word; words >> word; first = false) {
      const int columns = columns_of(word);
      if (!first && at + 1 + columns > width) out += margin, at = indent;
      else if (!first) out += ' ', ++at;
      out += word, at += columns;
    }
  }
  return out;
}

std::string labelled(const std::string& label, const std::string& text, int column, int width) {
  std::string out = "  " + label;
  if (text.empty()) return out + "\n";
  const int columns = columns_of(out);
  out += columns + 2 > column ? "\n" + std::string(std::size_t(column), ' ')
                              : std::string(std::size_t(column - columns), ' ');
  return out + wrapped(text, width, column, column) + "\n";
}

std::string spaced(std::string label) {
  std::replace(label.begin(), label.end(), '/', ' ');
  return label;
}

std::string wrapped_command(const std::string& command, int width) {
  std::istringstream lines(wrapped(command, columns_of(command) > width ? width - 2 : width, 4));
  std::string out;
  for (std::string line; std::getline(lines, line);) out += (out.empty() ? "" : " \\\n") + line;
  return unbroken(out);
}

std::string unbroken(std::string command) {
  std::replace(command.begin(), command.end(), '\x1f', ' ');
  return command;
}

std::string with_thousands(std::size_t value) {
  std::string text = std::to_string(value);
  for (int at = int(text.size()) - 3; at > 0; at -= 3) text.insert(std::size_t(at), ",");
  return text;
}

std::vector<int> TextTable::widths() const {
  std::vector<int> widths;
  int before = 0;
  for (std::size_t c = 0; c < columns_.size(); ++c) {
    int width = 0;
    for (const auto& cells : rows_)
      if (cells.size() > 1) width = std::max(width, columns_of(cells[c]));
    if (width > 0) width = std::min(columns_[c].most, std::max(width, columns_of(columns_[c].title)));
    if (c + 1 == columns_.size() && width > width_ - before - 2) width = width_ - before - 2;
    if (width < std::min(6, columns_of(columns_[c].title))) width = 0;  // too little to say anything
    before += width > 0 ? 2 + width : 0;
    widths.push_back(width);
  }
  return widths;
}

std::string TextTable::text() const {
  const std::vector<int> widths = this->widths();
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
    out += cells.size() == 1 ? cut_to_columns("  " + cells[0], width_) + "\n"
                             : line_of([&](std::size_t c) { return cells[c]; });
  return out;
}

}  // namespace penumbra
