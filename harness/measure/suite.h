// Suites: which techniques on which scenes. The format is described in docs/suites.md.
#pragma once

#include "harness/measure/external.h"
#include "harness/results/published_time.h"
#include "scenes/scene_file.h"
#include "techniques/registry.h"

namespace penumbra {

/// A technique, a backend and parameters: what a row measures. Or an external technique.
struct Variant {
  const Entry* entry = nullptr;
  Parameters parameters;                          ///< resolved
  int threads = 1;                                ///< 0: not known, of an external one
  std::shared_ptr<const External> external = {};  ///< what runs it, if it is not this program
  /// "name/backend/param:value/.../threads:n" without threads that are not known and without parameters that have their
  /// defaults: for file names and progress.
  std::string label() const;
};

struct Suite {
  std::string name;
  std::vector<std::string> scenes;
  std::string scenes_where;           ///< "file:line: key 'scenes'", or the option that replaced it, for messages
  std::string spheres_where;          ///< "file:line" of the key
  std::vector<SphereChoice> spheres;  ///< what replaces the scenes' own sphere sets; one empty entry: nothing does
  std::vector<Variant> variants;
  int repetitions = 9;
  double truth_noise = 0.002;
  bool sequence = false;                       ///< score every frame of a motion, not one
  bool attribution = false;                    ///< ask techniques what each of their approximations costs
  std::string published;                       ///< table of results/published to print beside, or empty
  std::vector<PublishedTime> published_times;  ///< lines of `published` if it holds times, not frame rates
  std::optional<Variant> baseline;             ///< whose image is one more reference, named after its technique
};

Variant variant_of(std::shared_ptr<const External> external);

/// Loads a shipped suite by name or a file by path, and expands every axis. `threads` replaces "all" (0: all cores).
/// `scenes`, names or paths, replace the suite's own. Throws Error naming file, line, key and what is allowed. The
/// registry outlives the suite.
Suite load_suite(const std::string& name_or_path, const Registry& registry, int threads,
                 const std::vector<std::string>& scenes = {});

}  // namespace penumbra
