// Scene files: TOML to Scene. The format is described in docs/scene-files.md.
#pragma once

#include "scenes/scene.h"

namespace penumbra {

/// Loads a shipped scene by name or a file by path. Throws Error naming file, line, key and what is allowed.
Scene load_scene(const std::string& name_or_path);

}  // namespace penumbra
