#include "scenes/storage/cache.h"

#include <cstdlib>
#include <filesystem>

namespace penumbra {

std::string cache_folder() {
  if (const char* folder = std::getenv("PENUMBRA_CACHE")) return folder;
  if (const char* folder = std::getenv("XDG_CACHE_HOME")) return std::string(folder) + "/penumbra";
  const char* home = std::getenv("HOME");
  return (home ? std::string(home) : std::string("/tmp")) + "/.cache/penumbra";
}

bool CacheEntry::exists() const {
  std::error_code none;  // what cannot be looked at is not there
  return std::filesystem::exists(path(), none);
}

}  // namespace penumbra
