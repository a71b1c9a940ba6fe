// Scene files: TOML to Scene. The format is described in docs/scene-files.md.
#pragma once

#include <optional>

#include "scenes/fit/fit.h"
#include "scenes/scene.h"

namespace penumbra {

/// What a suite puts in place of a scene file's `spheres` and `objective`.
struct SphereChoice {
  std::optional<int> count;
  std::optional<Objective> objective;
};

class TomlReader;

/// Key `name` of a scene or suite file. Throws Error naming file, line and what is allowed.
std::string read_name(TomlReader& file);

/// What a scene file calls itself, without loading anything else of it.
struct SceneName {
  std::string name, file, where;  ///< where: "file:line" of the key
};
SceneName read_scene_name(const std::string& name_or_path);

/// Loads a shipped scene by name or a file by path. Fits of spheres come from the cache where it holds them.
/// Throws Error naming file, line, key and what is allowed.
Scene load_scene(const std::string& name_or_path, const SphereChoice& choice = {});

}  // namespace penumbra
