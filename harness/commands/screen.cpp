#include "harness/commands/screen.h"

#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <sstream>

namespace penumbra {
namespace {

constexpr int narrowest = 40, widest = 100;

/// Columns of UTF-8 text: its letters, not its bytes.
int columns_of(const std::string& text) {
  return int(
      std::count_if(text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xc0) != 0x80; }));
}

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

}  // namespace penumbra
