// How much of a plan is left to do, so that a run can say for how long.
#pragma once

#include <map>

#include "harness/measure/plan.h"
#include "harness/measure/progress.h"

namespace penumbra {

/// Steps by kind: "fit", "reference", "baseline", "sequence", "check" of a variant, and "time", one repetition of one.
using StepCounts = std::map<std::string, int>;

/// The kind of a job's step; a measurement's is its check, and "time" comes once that is over.
std::string step_kind(Job::Kind kind);

/// All steps that a scene of a plan may ask for.
StepCounts steps_of(const PlannedScene& scene, int repetitions);
StepCounts sum(StepCounts a, const StepCounts& b);

/// Tells the progress that these steps are left.
void announce(const StepCounts& left, Progress& progress);

}  // namespace penumbra
