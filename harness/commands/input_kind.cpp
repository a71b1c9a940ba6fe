#include "harness/commands/input_kind.h"

#include <algorithm>
#include <filesystem>
#include <set>

#include "scenes/assets.h"
#include "scenes/environment.h"
#include "scenes/error.h"
#include "scenes/shapes.h"
#include "scenes/toml_reader.h"

namespace penumbra {
namespace {

bool holds(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

/// Of a TOML file. What cannot be read is for its reader to complain of.
InputKind kind_of_toml(const std::string& file) {
  try {
    TomlReader reader = TomlReader::open(file);
    if (reader.has("technique") || reader.has("scenes")) return InputKind::suite;
    if (reader.has("occluder") || reader.has("receivers") || reader.has("light")) return InputKind::scene;
  } catch (const Error&) {
  }
  return InputKind::unknown;
}

InputKind kind_of_extension(std::string extension) {
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return std::tolower(c); });
  static const std::set<std::string> images = {".exr",  ".hdr", ".pic",  ".png", ".jpg",
                                               ".jpeg", ".tif", ".tiff", ".tga"};
  static const std::set<std::string> meshes = {".obj", ".ply", ".glb", ".gltf", ".stl", ".3ds", ".off", ".dae", ".fbx"};
  if (images.contains(extension)) return InputKind::environment;
  return meshes.contains(extension) ? InputKind::mesh : InputKind::unknown;
}

bool is_built_in_environment(const std::string& name) {
  Environment environment;
  return make_environment(name, environment);
}

bool is_asset(const std::string& name, const std::string& kind) {
  return std::any_of(assets().begin(), assets().end(),
                     [&](const Asset& asset) { return asset.name == name && asset.kind == kind; });
}

/// Every kind of thing that is called so; a file is one thing.
std::set<InputKind> kinds_of(const std::string& name, const Registry& registry) {
  if (std::filesystem::is_regular_file(name))
    return {name.ends_with(".toml") ? kind_of_toml(name) : kind_of_extension(std::filesystem::path(name).extension())};
  std::set<InputKind> kinds;
  if (holds(shipped_names("library"), name)) kinds.insert(InputKind::scene);
  if (holds(shipped_names("suites"), name)) kinds.insert(InputKind::suite);
  if (Mesh mesh; make_shape(name, mesh) || is_asset(name, "mesh")) kinds.insert(InputKind::mesh);
  if (is_built_in_environment(name) || is_asset(name, "environment")) kinds.insert(InputKind::environment);
  for (const Entry& entry : registry.entries())
    if (entry.name == name) kinds.insert(InputKind::technique);
  return kinds;
}

/// The commands that take it.
std::string meant(const std::string& name, InputKind kind) {
  switch (kind) {
    case InputKind::scene:
      return fmt::format(
          "a scene: `penumbra run quick --scene {0}` measures every family on it, `penumbra choose {0} "
          "--error 2%` finds the cheapest technique within 2 % (about a minute each)",
          name);
    case InputKind::suite:
      return fmt::format("a suite: `penumbra run {0}` measures it, `penumbra run {0} --dry-run` says what and how long",
                         name);
    case InputKind::mesh:
      return fmt::format(
          "a mesh: `penumbra choose {0} --error 2%` finds the technique for it (about a minute), "
          "`penumbra init DIR --mesh {0}` writes a scene and a suite with it",
          name);
    case InputKind::environment:
      return fmt::format(
          "a light: `penumbra choose MESH --light {} --error 2%` finds the technique for a mesh under it", name);
    case InputKind::technique:
      return fmt::format("a technique: `penumbra list {}` says what it is, takes and is measured by", name);
    case InputKind::unknown:
      break;
  }
  return "";
}

void expect(const std::string& name, const Registry& registry, InputKind wanted, const char* wanted_word) {
  if (is_called(name, wanted, registry)) return;
  if (const std::string what = what_it_is(name, registry); !what.empty())
    throw Error("'{}' is no {} but {}", name, wanted_word, what);
}

}  // namespace

bool is_called(const std::string& name, InputKind kind, const Registry& registry) {
  return kinds_of(name, registry).contains(kind);
}

std::string what_it_is(const std::string& name, const Registry& registry) {
  const std::set<InputKind> kinds = kinds_of(name, registry);
  return kinds.empty() ? "" : meant(name, *kinds.begin());
}

void expect_scene(const std::string& name, const Registry& registry) {
  expect(name, registry, InputKind::scene, "scene");
}

void expect_suite(const std::string& name, const Registry& registry) {
  expect(name, registry, InputKind::suite, "suite");
}

}  // namespace penumbra
