// Text of mesh files: bytes of a file, numbers, lines. Independent of the locale.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace penumbra {

/// All bytes of a file. Throws Error if it cannot be read.
std::string read_bytes(const std::string& path);

/// The bytes without a UTF-8 byte-order mark. Throws Error naming `path` if the text is UTF-16 or not text at all.
std::string_view text_of(const std::string& bytes, const std::string& path);

/// A whole token as a number, correctly rounded: `+1`, `.5`, `5.`, `1e-3`, `nan`, `inf`; too large is infinite, too
/// small 0.
std::optional<double> to_number(std::string_view token);

/// The next token of `rest`, which it leaves; empty at the end. Blanks and line ends separate tokens.
std::string_view next_token(std::string_view& rest);

/// Lines that end at LF, CRLF or CR. # begins a comment; a backslash that ends a line, but no comment, joins the next.
class Lines {
 public:
  explicit Lines(std::string_view text) : rest_(text) {}
  bool next(std::string_view& line);
  std::size_t number() const { return number_; }  ///< of the line that next() gave, from 1

 private:
  std::string_view physical_line();
  std::string_view rest_;
  std::string joined_;
  std::size_t number_ = 0, read_ = 0;
};

}  // namespace penumbra
