// Scene files: TOML to Scene. The format is described in docs/scene-files.md.
#pragma once

#include <optional>

#include "scenes/scene.h"

namespace penumbra {

/// Loads a shipped scene by name or a file by path; `spheres` replaces the file's sphere set by a fit of so many.
/// Throws Error naming file, line, key and what is allowed.
Scene load_scene(const std::string& name_or_path, std::optional<int> spheres = {});

}  // namespace penumbra
