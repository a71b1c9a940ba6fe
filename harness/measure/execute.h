// Does the jobs of a plan, scene after scene, one scene in memory at a time.
#pragma once

#include "harness/measure/plan.h"
#include "harness/measure/progress.h"
#include "harness/results/results_folder.h"

namespace penumbra {

/// Loads every scene of a plan once, without its fit, to find wrong input before anything is measured. Returns
/// truth_key() by name of scene. Throws Error.
std::map<std::string, std::string> check_scenes(const Plan& plan);

/// Told that a scene is over: where its images are, below the folder of results, and whether it has new rows.
using SceneDone = std::function<void(const std::string& images, bool changed)>;

/// Does what is left to do: a row of `earlier` with the same name and key and at least as many repetitions is taken
/// over, and jobs that only such rows need are not done. Rows join the folder as soon as they are finished. What goes
/// wrong on one scene makes its rows fail, and the next scene is tried. Returns early when interrupted. Returns how
/// many rows were taken over.
std::size_t execute(const Plan& plan, const Registry& registry, const std::vector<Row>& earlier, ResultsFolder& folder,
                    const SceneDone& scene_done);

}  // namespace penumbra
