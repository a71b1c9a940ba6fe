// What is said to people on the way: lines on standard error, through spdlog's default logger. A source that formats
// with spdlog itself compiles for seconds longer.
#pragma once

#include <fmt/format.h>

#include <string>

namespace penumbra {

void log_warning(const std::string& line);
void log_information(const std::string& line);

/// Something that may make results worth less than expected.
template <class... Args>
void warn(fmt::format_string<Args...> text, Args&&... args) {
  log_warning(fmt::format(text, std::forward<Args>(args)...));
}

/// Something that is good to know.
template <class... Args>
void inform(fmt::format_string<Args...> text, Args&&... args) {
  log_information(fmt::format(text, std::forward<Args>(args)...));
}

}  // namespace penumbra
