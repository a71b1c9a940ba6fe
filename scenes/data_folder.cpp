#include "scenes/data_folder.h"

#include <cstdlib>
#include <filesystem>

#include "scenes/error.h"

namespace penumbra {
namespace fs = std::filesystem;
namespace {

bool is_data(const fs::path& folder) {
  return fs::is_regular_file(folder / "assets.toml");
}

}  // namespace

std::string data_folder() {
  if (const char* given = std::getenv("PENUMBRA_DATA")) {
    if (is_data(given)) return given;
    throw Error(
        "PENUMBRA_DATA is '{}', which holds no assets.toml; it should name the folder scenes of the sources, or "
        "share/penumbra/scenes of an installation",
        given);
  }
  std::error_code unknown;
  const fs::path program = fs::read_symlink("/proc/self/exe", unknown);
  const fs::path installed = (program.parent_path() / PENUMBRA_INSTALLED_DATA).lexically_normal();
  const fs::path sources = PENUMBRA_SOURCE_DATA;
  if (is_data(installed)) return installed.string();
  if (is_data(sources)) return sources.string();
  throw Error(
      "penumbra's scenes and suites (a folder with assets.toml) are neither in {} nor in {}; set PENUMBRA_DATA "
      "to where they are",
      installed.string(), sources.string());
}

}  // namespace penumbra
