// What a scene file says of itself, without loading or fitting anything: enough to plan a run.
#pragma once

#include "scenes/scene_file.h"

namespace penumbra {

struct SceneOutline {
  std::string name, file, where;  ///< where: "file:line" of the name
  std::size_t spheres = 0;        ///< that are given or asked for; a fit may need fewer
  std::string objective;          ///< of a fit; empty if the spheres are given
  bool environment = true;        ///< lit from all around
  bool lamps = false;             ///< lit by lamps, alone or besides
  bool fitted() const { return !objective.empty(); }
  /// "for shadow", "of mixed origin" or "given".
  std::string origin_of_spheres() const {
    return objective == "mixed" ? "of mixed origin" : fitted() ? "for " + objective : "given";
  }
};

/// Reads a shipped scene or a file, and checks only the keys that it needs. Throws Error naming file, line and what is
/// allowed there.
SceneOutline read_outline(const std::string& name_or_path, const SphereChoice& choice = {});

}  // namespace penumbra
