#include "scenes/assets.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <memory>

#include "scenes/nearest_name.h"
#include "scenes/shapes.h"
#include "scenes/storage/atomic_write.h"
#include "scenes/storage/cache.h"
#include "scenes/storage/content_key.h"
#include "scenes/toml_reader.h"

namespace penumbra {
namespace fs = std::filesystem;

const std::vector<Asset>& assets() {
  static const std::vector<Asset> all = [] {
    std::vector<Asset> list;
    TomlReader file = TomlReader::open(data_folder() + "/assets.toml");
    for (TomlReader& entry : file.tables("asset")) {
      const auto text = [&](const char* key) { return entry.required(key, entry.text(key), "a string"); };
      list.push_back({text("name"), text("kind"), text("file"), text("package"), text("licence"),
                      entry.text("member").value_or("")});
      entry.finish();
    }
    file.finish();
    return list;
  }();
  return all;
}

namespace {

/// What `tar` writes of a member of an archive. Throws Error.
std::string unpack(const Asset& asset) {
  const std::string command = fmt::format("tar -xzOf '{}' '{}' 2>/dev/null", asset.file, asset.member);
  const std::unique_ptr<FILE, int (*)(FILE*)> pipe(popen(command.c_str(), "r"), pclose);
  std::string bytes;
  std::array<char, 1 << 16> part;
  for (std::size_t read = 1; pipe && read > 0;)
    bytes.append(part.data(), read = std::fread(part.data(), 1, part.size(), pipe.get()));
  if (bytes.empty()) throw Error("{}: `tar` cannot read {} in it", asset.file, asset.member);
  return bytes;
}

std::string unpacked_file(const Asset& asset) {
  ContentHash key(1);
  key.add(asset.file), key.add(asset.member), key.add_value(std::uint64_t(fs::file_size(asset.file)));
  std::string path =
      fmt::format("{}/asset-{}{}", cache_folder(), key.digest(), fs::path(asset.member).extension().string());
  if (!fs::exists(path)) {
    make_folder(cache_folder());
    write_atomically(path, std::string_view(unpack(asset)));
  }
  return path;
}

}  // namespace

std::string asset_file(const std::string& name, const std::string& kind) {
  for (const Asset& asset : assets()) {
    if (asset.name != name || asset.kind != kind) continue;
    if (!fs::exists(asset.file))
      throw Error("{} '{}' is not installed: {} is missing; install the package {} (scripts/setup.sh does)", kind, name,
                  asset.file, asset.package);
    return asset.member.empty() ? asset.file : unpacked_file(asset);
  }
  return "";
}

std::string asset_names(const std::string& kind) {
  std::vector<std::string> names;
  for (const Asset& asset : assets())
    if (asset.kind == kind) names.push_back(asset.name);
  return fmt::format("{}", fmt::join(names, ", "));
}

std::vector<std::string> shipped_names(const std::string& folder) {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(data_folder() + "/" + folder))
    if (entry.path().extension() == ".toml") names.push_back(entry.path().stem().string());
  std::sort(names.begin(), names.end());
  return names;
}

Mesh mesh_by_name(const std::string& name_or_path) {
  Mesh mesh;
  if (make_shape(name_or_path, mesh)) return mesh;
  const std::string file = asset_file(name_or_path, "mesh");
  return load_mesh(file.empty() ? name_or_path : file);
}

std::string shipped_file(const std::string& name, const std::string& folder) {
  if (fs::is_regular_file(name) || name.ends_with(".toml")) return name;
  std::string file = data_folder() + "/" + folder + "/" + name + ".toml";
  if (fs::exists(file)) return file;
  const std::vector<std::string> shipped = shipped_names(folder);
  throw Error("'{}' is neither a file nor shipped; shipped are: {}{}", name, fmt::join(shipped, ", "),
              did_you_mean(name, shipped));
  return file;
}

}  // namespace penumbra
