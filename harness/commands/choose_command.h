// penumbra choose: a scene for a mesh and a light, the search, and the screen.
#pragma once

#include "harness/choose/choose.h"
#include "harness/choose/new_scene.h"

namespace penumbra {

struct ChooseOptions {
  std::string subject;  ///< mesh or scene
  SceneRequest scene;   ///< for a mesh
  std::string error, budget;
  std::string directory = "results/runs/choose";
  ChooseSettings settings;
  bool json = false, path = false;
};

/// Returns the exit code: 0 answered, be it that nothing reaches the bound, 1 results could not be written, 130
/// interrupted. Throws Error for wrong input.
int choose_technique(ChooseOptions options);

}  // namespace penumbra
