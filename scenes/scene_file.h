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
  bool fitted = true;        ///< false: a fit is left out, to look at all else of the scene
  bool only_cached = false;  ///< a fit that is not in the cache is left out
};

class TomlReader;

/// Key `name` of a scene or suite file; without it the file's name, less its extension. Throws Error naming file, line
/// and what is allowed.
std::string read_name(TomlReader& file);

/// Loads a shipped scene by name or a file by path. Fits of spheres come from the cache where it holds them; `progress`
/// is told how far one is that does not. Throws Error naming file, line, key and what is allowed.
Scene load_scene(const std::string& name_or_path, const SphereChoice& choice = {}, const FitProgress& progress = {});

}  // namespace penumbra
