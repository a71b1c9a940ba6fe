// A scene in files that other people's renderers read (docs/other-renderers.md).
#pragma once

#include <string>

#include "scenes/scene.h"

namespace penumbra {

/// Writes all that the image of one frame depends on into a folder, which it makes: scene.json describes the rest,
/// mesh.ply, spheres.json, receivers.exr and .ply, light.exr and .pfm (a lamp is in scene.json). Lengths in metres from
/// Scene::origin. Throws Error if it cannot be written.
void export_scene(const Animation& animation, const Frame& frame, const std::string& directory);

}  // namespace penumbra
