// Suites: which techniques on which scenes. The format is described in docs/suites.md.
#pragma once

#include "scenes/scene_file.h"
#include "techniques/registry.h"

namespace penumbra {

/// A technique, a backend and parameters: what a row measures.
struct Variant {
  const Entry* entry = nullptr;
  Parameters parameters;  ///< resolved
  int threads = 1;
  std::string label() const;  ///< "name/backend/param=value,.../threads:n"
};

struct Suite {
  std::string name;
  std::vector<std::string> scenes;
  std::vector<SphereChoice> spheres;  ///< what replaces the scenes' own sphere sets; one empty entry: nothing does
  std::vector<Variant> variants;
  int repetitions = 9;
  double truth_noise = 0.002;
  bool sequence = false;     ///< score every frame of a motion, not one
  bool attribution = false;  ///< ask techniques what each of their approximations costs
  std::string published;     ///< table of results/published to print beside, or empty
};

/// Loads a shipped suite by name or a file by path, and expands every axis. `threads` replaces "all" (0: all cores).
/// Throws Error naming file, line, key and what is allowed. The registry outlives the suite.
Suite load_suite(const std::string& name_or_path, const Registry& registry, int threads);

}  // namespace penumbra
