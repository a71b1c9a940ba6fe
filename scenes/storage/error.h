// The one exception of the project: what was wrong, where, and how to mend it, on one line.
#pragma once

#include <fmt/format.h>

#include <stdexcept>

namespace penumbra {

/// Wrong input: a file, a key, a parameter, an asset. Commands print it and exit with code 2.
class Error : public std::runtime_error {
 public:
  template <class... Args>
  explicit Error(fmt::format_string<Args...> text, Args&&... args)
      : std::runtime_error(fmt::format(text, std::forward<Args>(args)...)) {}
};

}  // namespace penumbra
