// A run is plan -> job -> merge: what is to be done, each piece by name, and what it needs. Looks at files' outlines
// alone; nothing is loaded, fitted or measured.
#pragma once

#include "harness/measure/reference.h"
#include "harness/measure/suite.h"
#include "harness/results/row.h"
#include "scenes/scene_outline.h"

namespace penumbra {

/// One piece of work. What it yields depends on its key's words and on the files that these name.
struct Job {
  /// fit: a scene with its spheres; reference: one rung; sequence: truths of all frames; baseline: an image;
  /// measurement: a row.
  enum class Kind { fit, reference, sequence, baseline, measurement };
  Kind kind = Kind::fit;
  std::string key;                 ///< unique in the plan
  std::vector<std::string> needs;  ///< keys of jobs that come before
  Rung rung = Rung::truth;         ///< reference
  int resolution = 0;              ///< reference; 0 where the rung has none
  std::size_t variant = 0;         ///< measurement: in Suite::variants
};

/// A scene with one choice of spheres, and the jobs on it, in an order in which they can be done.
struct PlannedScene {
  std::string listed;  ///< as the suite lists it
  SphereChoice choice;
  SceneOutline outline;
  std::vector<Job> jobs;
  std::size_t measurements() const;
};

struct Plan {
  const Suite* suite = nullptr;  ///< outlives the plan
  int repetitions = 1;
  std::vector<PlannedScene> scenes;
};

/// Expands a suite. `filter`: regular expression searched in row names; a scene of which it leaves nothing is not in
/// the plan. Variants that do not look at spheres are measured with the first choice of spheres that is left.
/// `repetitions`: 0 for the suite's. Throws Error for scenes or spheres that stand twice, for a filter that is none or
/// leaves nothing, and where nothing that is left can run on this machine.
Plan make_plan(const Suite& suite, const std::string& filter, int repetitions);

/// What a variant is called on a scene of so many spheres; the number of receivers is not known yet.
RowIdentity identity_of(const SceneOutline& scene, const Variant& variant);

/// The texels along an edge of a cube face at which a variant works: its parameter "resolution", or 32.
int resolution_of(const Parameters& parameters);

/// SHA-1 over all that a row depends on but the program and the machine: the content of its scene (`scene_key` and its
/// motions), the variant, and what the suite wants to know of it.
std::string measurement_key(const std::string& scene_key, const Scene& scene, const RowIdentity& id,
                            const Suite& suite);

}  // namespace penumbra
