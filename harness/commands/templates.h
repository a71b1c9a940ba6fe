// Files to start from: every key of a scene and of a suite, with ranges, defaults and meaning. `help` shows them,
// `init` writes them, and docs/ quotes them.
#pragma once

#include <string>

namespace penumbra {

/// Text of scenes/templates/scene.toml. Throws Error if it is not there.
std::string scene_template();

/// scene_template() with a mesh file of one's own, and without spheres if it is not `closed`, as a fit asks for.
std::string scene_template(const std::string& mesh, bool closed);

/// Text of scenes/templates/suite.toml. Throws Error if it is not there.
std::string suite_template();

}  // namespace penumbra
