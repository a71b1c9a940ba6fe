// penumbra init: a scene and a suite to start from.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>

#include "harness/commands/commands.h"
#include "harness/commands/templates.h"
#include "harness/report/screen.h"
#include "scenes/assets.h"
#include "scenes/error.h"
#include "scenes/fit/solid.h"
#include "scenes/log.h"
#include "scenes/storage/atomic_write.h"

namespace penumbra {
namespace {

namespace fs = std::filesystem;

/// Can spheres be fitted to it? If not, says why.
bool is_closed(const std::string& name) {
  const Mesh mesh = mesh_by_name(name);
  try {
    make_solid(mesh, name);
    return true;
  } catch (const Error& e) {
    warn("{}; the scene is written without spheres, so techniques that need them are skipped", e.what());
    return false;
  }
}

std::string scene_text(const std::string& mesh) {
  if (mesh.empty()) return scene_template();
  // A file is named from the root, so that the scene may be moved.
  return scene_template(fs::is_regular_file(mesh) ? fs::absolute(mesh).lexically_normal().string() : mesh,
                        is_closed(mesh));
}

void init(const std::string& folder, const std::string& mesh) {
  const std::string scene = (fs::path(folder) / "scene.toml").string(),
                    suite = (fs::path(folder) / "suite.toml").string();
  for (const std::string& file : {scene, suite})
    if (fs::exists(file)) throw Error("{} is there already, and is left as it is; name another folder", file);
  const std::string text = scene_text(mesh);
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) throw Error("{}: cannot be created: {}", folder, error.message());
  write_atomically(scene, text);
  write_atomically(suite, suite_template());
  const std::string next = fmt::format("penumbra run {} --out {}", suite, (fs::path(folder) / "results").string());
  fmt::print("{}: what blocks light, where it falls, the light\n{}: the techniques to measure\n", scene, suite);
  fmt::print("Next (about a minute; --dry-run says what):\n  {}\n", wrapped(next, screen_width(), 4, 2));
}

}  // namespace

void add_init(CLI::App& app, int&) {
  auto* command = app.add_subcommand("init", "Write a scene and a suite with comments, to change and to run");
  static std::string folder, mesh;
  command->add_option("dir", folder, "Folder to write scene.toml and suite.toml to; nothing is overwritten")
      ->default_val(".");
  command->add_option("--mesh", mesh, "Mesh file, asset or shape that the scene shows");
  command->callback([] { init(folder, mesh); });
}

}  // namespace penumbra
