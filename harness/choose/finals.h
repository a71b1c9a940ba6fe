// The last step of a choice: candidates are checked against their scalar twins, timed side by side, and explained.
#pragma once

#include "harness/choose/answer.h"
#include "harness/choose/trials.h"
#include "harness/measure/progress.h"

namespace penumbra {

/// Per technique the trials that one look puts within 30 % of its best under the bound (three at most), or the nearest
/// to it.
std::vector<const Trial*> finalists(const std::vector<std::unique_ptr<Trial>>& trials, const Bound& bound);

/// Checks and times them in interleaved repetitions. A row that fails says why; the others stand.
std::vector<Option> timed(const std::vector<const Trial*>& candidates, const Trials& trials, const Registry& registry,
                          const Bound& bound, int repetitions, ResultsFolder& folder, Progress& progress);

/// The best option of each technique, best first: within the bound by time (or, under a bound of time, by error), then
/// the others by how near they come to it.
std::vector<Option> best_of_each(std::vector<Option> options, const Bound& bound);

/// The parts of an option's error, the largest first.
std::vector<ErrorPart> parts_of(const Trial& trial, const Trials& trials);

/// A configuration's name: technique, spheres, and the knobs that are not at their defaults; the fine one always.
std::string label_of(const Variant& variant, const Row& row);

}  // namespace penumbra
