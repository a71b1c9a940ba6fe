#include "harness/results/text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace penumbra {
namespace {

/// Bytes of the letter that begins at `at`; 1 for what is no UTF-8.
std::size_t letter_size(const std::string& text, std::size_t at) {
  const auto byte = [&](std::size_t k) { return static_cast<unsigned char>(text[k]); };
  const std::size_t size = byte(at) >= 0xF0 ? 4 : byte(at) >= 0xE0 ? 3 : byte(at) >= 0xC0 ? 2 : 1;
  if (at + size > text.size()) return 1;
  for (std::size_t k = at + 1; k < at + size; ++k)
    if ((byte(k) & 0xC0) != 0x80) return 1;
  return size;
}

/// East Asian letters and pictographs take two columns, and all begin behind U+1100 (E1 84 80 in UTF-8); of what lies
/// between, punctuation and symbols (E2 80 80 to E2 B9 BF) take one.
int letter_columns(const std::string& text, std::size_t at, std::size_t size) {
  if (size < 3) return 1;
  const std::string letter = text.substr(at, size);
  return letter < "\xE1\x84\x80" || (letter >= "\xE2\x80\x80" && letter < "\xE2\xBA\x80") ? 1 : 2;
}

}  // namespace

int columns_of(const std::string& text) {
  int columns = 0;
  for (std::size_t at = 0, size = 0; at < text.size(); at += size) {
    size = letter_size(text, at);
    columns += letter_columns(text, at, size);
  }
  return columns;
}

std::string cut_to_columns(const std::string& text, int columns) {
  if (columns_of(text) <= columns) return text;
  int used = 1;  // the ellipsis
  std::size_t at = 0;
  while (at < text.size()) {
    const std::size_t size = letter_size(text, at);
    used += letter_columns(text, at, size);
    if (used > columns) break;
    at += size;
  }
  return columns > 0 ? text.substr(0, at) + "…" : "";
}

std::string cut_in_middle(const std::string& text, int columns) {
  if (columns_of(text) <= columns) return text;
  const int end = columns / 5;
  std::size_t at = 0;
  for (int left = columns_of(text); at < text.size() && left > end;) {
    const std::size_t size = letter_size(text, at);
    left -= letter_columns(text, at, size);
    at += size;
  }
  return cut_to_columns(text, columns - columns_of(text.substr(at))) + text.substr(at);
}

std::string printable(const std::string& text) {
  const auto steers = [](const std::string& letter) {
    const auto first = static_cast<unsigned char>(letter[0]);
    if (letter.size() == 1) return first < 0x20 || first == 0x7F;
    if (letter.size() == 2) return letter < "\xC2\xA0";               // U+0080 to U+009F
    return (letter >= "\xE2\x80\x8E" && letter <= "\xE2\x80\x8F") ||  // marks, embeddings, overrides, isolates
           (letter >= "\xE2\x80\xA8" && letter <= "\xE2\x80\xAE") ||
           (letter >= "\xE2\x81\xA6" && letter <= "\xE2\x81\xA9");
  };
  std::string shown;
  for (std::size_t at = 0, size = 0; at < text.size(); at += size) {
    size = letter_size(text, at);
    const std::string letter = text.substr(at, size);
    shown += steers(letter) ? " " : letter;
  }
  return shown;
}

std::string first_letter(const std::string& text) {
  return text.empty() ? "" : text.substr(0, letter_size(text, 0));
}

std::string without_last_letter(const std::string& text) {
  std::size_t last = 0;
  for (std::size_t at = 0; at < text.size(); at += letter_size(text, at)) last = at;
  return text.substr(0, last);
}

std::string three_digits(double value) {
  if (std::abs(value) >= 99.95) return fmt::format("{:.0f}", value);
  const std::string text = fmt::format("{:.3g}", value);
  return text.find('e') == std::string::npos ? text : fmt::format("{:.2g}", value);
}

std::string duration_text(double seconds) {
  const double whole = std::ceil(std::clamp(seconds, 1.0, 1e9));
  const auto s = static_cast<long>(whole);
  if (s < 100) return fmt::format("{} s", s);
  if (s < 3600) return fmt::format("{} min {:02} s", s / 60, s % 60);
  return fmt::format("{} h {:02} min", s / 3600, s / 60 % 60);
}

}  // namespace penumbra
