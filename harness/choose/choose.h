// "Which technique for my mesh and my light?": searches the knobs of every technique for the cheapest configuration
// within an error, or the nearest to the truth within a time.
#pragma once

#include "harness/choose/answer.h"
#include "harness/measure/progress.h"
#include "harness/results/results_folder.h"
#include "techniques/registry.h"

namespace penumbra {

struct ChooseSettings {
  std::string scene;  ///< shipped name or file
  Bound bound;
  bool moving = false;  ///< the mesh deforms: frames count update; a scene at rest is made to twist
  /// After the search, look at every value of every knob and 8 to 256 spheres, and time all that may be the best: to
  /// see how good the search is.
  bool exhaustive = false;
  int threads = 0;  ///< 0: all cores
  int repetitions = 9;
  double patience = 90.0;  ///< s after the truth; fits of spheres that would end later are left out, and named
};

/// Errors of all configurations are compared on the scene's scored frame, against a truth whose noise is an eighth of
/// the bound (at most 0.5 %). Frames are timed in interleaved repetitions, of the candidates alone: per technique those
/// that one look puts within 30 % of its best. Rows join the folder. Throws Error for wrong input and where the truth
/// is black, Interrupted if it is to stop.
Answer choose(const ChooseSettings& settings, const Registry& registry, ResultsFolder& folder, Progress& progress);

}  // namespace penumbra
