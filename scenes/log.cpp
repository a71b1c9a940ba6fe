#include "scenes/log.h"

#include <spdlog/spdlog.h>

namespace penumbra {

void log_warning(const std::string& line) {
  spdlog::warn(line);
}

void log_information(const std::string& line) {
  spdlog::info(line);
}

}  // namespace penumbra
