#include "scenes/names.h"

#include <fmt/format.h>

#include <locale.h>

#include <algorithm>
#include <cwchar>
#include <cwctype>

namespace penumbra {
namespace {

/// How many bytes the control character at `at` has; 0 if there is none.
std::size_t control_bytes(const std::string& text, std::size_t at) {
  const auto byte = [&](std::size_t k) { return k < text.size() ? static_cast<unsigned char>(text[k]) : 0xffu; };
  if (byte(at) < 0x20 || byte(at) == 0x7f) return 1;
  return byte(at) == 0xc2 && byte(at + 1) >= 0x80 && byte(at + 1) < 0xa0 ? 2 : 0;  // C1 in UTF-8
}

/// For messages: the beginning, on one line, whatever the name holds.
std::string printable(const std::string& name) {
  constexpr std::size_t most = 60;
  std::string text;
  std::size_t at = 0;
  while (at < name.size() && at < most) {
    const std::size_t control = control_bytes(name, at);
    for (std::size_t k = 0; k < control; ++k)
      text += fmt::format("\\x{:02x}", static_cast<unsigned char>(name[at + k]));
    if (control == 0) text += name[at];
    at += std::max<std::size_t>(control, 1);
  }
  for (; at < name.size() && (static_cast<unsigned char>(name[at]) & 0xc0) == 0x80; ++at)
    text += name[at];  // whole letters
  return at < name.size() ? text + "..." : text;
}

/// The first character that no name may hold, as it is printed; empty if there is none.
std::string forbidden_character(const std::string& name) {
  for (std::size_t at = 0; at < name.size(); ++at) {
    const std::size_t control = control_bytes(name, at);
    if (control || name[at] == '/' || name[at] == '\\' || name[at] == '|')
      return printable(name.substr(at, std::max<std::size_t>(control, 1)));
  }
  return "";
}

/// A locale that knows the letters of all scripts; the language does not matter.
locale_t unicode() {
  static const locale_t locale = newlocale(LC_CTYPE_MASK, "C.UTF-8", nullptr);
  return locale;
}

}  // namespace

std::string name_fault(const std::string& name) {
  std::string fault;
  if (name.empty()) fault = "is empty";
  else if (const std::string bad = forbidden_character(name); !bad.empty()) fault = "holds '" + bad + "'";
  else if (name.front() == '.') fault = "begins with '.'";
  else if (name.front() == ' ' || name.back() == ' ') fault = "begins or ends with a space";
  else if (name.size() > longest_name) fault = fmt::format("has {} bytes", name.size());
  if (fault.empty()) return "";
  return fmt::format(
      "is '{}', which {}; allowed are 1 to {} bytes of text without / \\ | and control characters, not "
      "beginning with '.' or a space, not ending with a space: it names files",
      printable(name), fault, longest_name);
}

std::string file_name(std::string name) {
  for (char& c : name)
    if (c == '/' || c == ':' || c == ' ') c = '-';
  return name;
}

std::string file_name_key(const std::string& name) {
  const std::string mapped = file_name(name);
  const locale_t before = uselocale(unicode());
  std::string key;
  std::mbstate_t in{}, out{};
  for (std::size_t at = 0; at < mapped.size();) {
    wchar_t letter = 0;
    const std::size_t bytes = std::mbrtowc(&letter, mapped.data() + at, mapped.size() - at, &in);
    if (bytes == 0 || bytes > mapped.size() - at) {  // no UTF-8: kept as it is
      key += mapped[at++];
      in = {};
      continue;
    }
    char folded[16];
    const std::size_t written = std::wcrtomb(folded, wchar_t(std::towlower(wint_t(letter))), &out);
    key.append(folded, written <= sizeof folded ? written : 0);
    at += bytes;
  }
  uselocale(before);
  return key;
}

}  // namespace penumbra
