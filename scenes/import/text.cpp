#include "scenes/import/text.h"

#include <charconv>
#include <fstream>
#include <limits>

#include "scenes/error.h"

namespace penumbra {
namespace {

bool is_blank(char c) {
  return c == ' ' || c == '\t' || c == '\v' || c == '\f' || c == '\n' || c == '\r';
}

}  // namespace

std::string read_bytes(const std::string& path) {
  std::ifstream in(path, std::ios::binary | std::ios::ate);
  const std::streamoff size = in ? std::streamoff(in.tellg()) : -1;
  std::string bytes(size > 0 ? std::size_t(size) : 0, '\0');
  in.seekg(0);
  if (size < 0 || !in.read(bytes.data(), size)) throw Error("{}: cannot be read; check its permissions", path);
  return bytes;
}

std::string_view text_of(const std::string& bytes, const std::string& path) {
  std::string_view text = bytes;
  if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
  if (text.starts_with("\xFF\xFE") || text.starts_with("\xFE\xFF"))
    throw Error("{}: is UTF-16 text; save it as ASCII or UTF-8", path);
  if (text.substr(0, 4096).find('\0') != std::string_view::npos)
    throw Error("{}: is not text (it has zero bytes; UTF-16, or another format?); save it as ASCII or UTF-8", path);
  return text;
}

std::optional<double> to_number(std::string_view token) {
  if (token.size() > 1 && token[0] == '+' && token[1] != '-') token.remove_prefix(1);
  double value = 0.0;
  const auto [end, fault] = std::from_chars(token.data(), token.data() + token.size(), value);
  if (end != token.data() + token.size() || fault == std::errc::invalid_argument) return {};
  if (fault == std::errc::result_out_of_range) {
    const bool small = token.find("e-") != token.npos || token.find("E-") != token.npos;
    value = small ? 0.0 : std::numeric_limits<double>::infinity();
    return token[0] == '-' ? -value : value;
  }
  return value;
}

std::string_view next_token(std::string_view& rest) {
  std::size_t first = 0;
  while (first < rest.size() && is_blank(rest[first])) ++first;
  std::size_t last = first;
  while (last < rest.size() && !is_blank(rest[last])) ++last;
  const std::string_view token = rest.substr(first, last - first);
  rest.remove_prefix(last);
  return token;
}

std::string_view Lines::physical_line() {
  std::size_t end = 0;
  while (end < rest_.size() && rest_[end] != '\n' && rest_[end] != '\r') ++end;
  const std::string_view line = rest_.substr(0, end);
  if (rest_.substr(end).starts_with("\r\n")) ++end;
  rest_.remove_prefix(std::min(end + 1, rest_.size()));
  ++read_;
  return line;
}

bool Lines::next(std::string_view& line) {
  if (rest_.empty()) return false;
  number_ = read_ + 1;
  bool more = false;
  joined_.clear();
  do {
    line = physical_line();
    const std::size_t comment = line.find('#');
    const bool has_comment = comment != line.npos;
    line = line.substr(0, comment);
    std::size_t size = line.size();
    while (size > 0 && is_blank(line[size - 1])) --size;
    more = !has_comment && size > 0 && line[size - 1] == '\\';
    if (more) line = line.substr(0, size - 1);
    if (more || !joined_.empty()) joined_.append(line) += ' ';
  } while (more && !rest_.empty());
  if (!joined_.empty()) line = joined_;
  return true;
}

}  // namespace penumbra
