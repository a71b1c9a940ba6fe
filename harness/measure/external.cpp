#include "harness/measure/external.h"

#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>

#include "harness/measure/child_process.h"
#include "harness/results/row.h"
#include "scenes/storage/content_key.h"

namespace penumbra {
namespace {

void replace_all(std::string& text, const std::string& what, const std::string& by) {
  for (std::size_t at = 0; (at = text.find(what, at)) != std::string::npos; at += by.size())
    text.replace(at, what.size(), by);
}

}  // namespace

std::shared_ptr<const External> make_external(const std::string& name, const std::string& command,
                                              const std::string& folder, double timeout_s, bool reads_spheres) {
  External external;
  external.entry.name = name, external.entry.backend = Backend::external;
  external.entry.lights = {true, true};
  external.entry.reads_spheres = [reads_spheres](const Parameters&) { return reads_spheres; };
  external.entry.make = [](const Parameters&) -> std::unique_ptr<Technique> {
    throw std::logic_error("an external technique lives in another program");
  };
  external.command = command, external.folder = folder, external.timeout_s = timeout_s;
  return std::make_shared<const External>(std::move(external));
}

std::string external_key(const External& external, const std::string& key) {
  ContentHash hash;
  hash.add(key), hash.add(external.command);
  std::istringstream words(external.command);
  for (std::string word; words >> word;) {
    const std::filesystem::path path = std::filesystem::path(external.folder) / word;
    std::error_code ignored;
    if (!std::filesystem::is_regular_file(path, ignored)) continue;
    std::ifstream file(path, std::ios::binary);
    hash.add(std::string(std::istreambuf_iterator<char>(file), {}));
  }
  return hash.digest();
}

std::string command_for(const External& external, const std::string& scene_folder, const std::string& image_file) {
  std::string command = external.command;
  replace_all(command, "{scene}", shell_word(scene_folder));
  replace_all(command, "{out}", shell_word(image_file));
  return command;
}

}  // namespace penumbra
