// The Markdown tables of finished rows. Each is empty where no row has anything to show in it.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "harness/results/row.h"

namespace penumbra {

/// What stands on top of a run's tables: suite, machine, date, repetitions, commit, from the context of results.json
/// and the rows under it. What the context does not say is left out.
std::string make_heading(const nlohmann::json& context, const std::vector<Row>& rows);

/// Per scene, rows by frame time with their rank by error against truth; Pareto-optimal rows are marked.
std::string make_table(const std::vector<Row>& rows);

/// Per scene, the cheapest row of each technique under 1, 3 and 10 % of error against truth: of rows that are equally
/// fast within their noise, the nearest.
std::string make_choice_table(const std::vector<Row>& rows);

/// Errors against a suite's baseline.
std::string make_baseline_table(const std::string& baseline, const std::vector<Row>& rows);

/// Per scene, times of the rows' sub-stages.
std::string make_stages_table(const std::vector<Row>& rows);

/// Per scene, errors, flicker and coverage over a motion's frames.
std::string make_sequence_table(const std::vector<Row>& rows);

/// What each approximation of a technique adds to its error.
std::string make_steps_table(const std::vector<Row>& rows);

/// What the commands of external techniques took, start and loading included.
std::string make_external_table(const std::vector<Row>& rows);

/// Rows whose counters are not zero.
std::string make_counters_table(const std::vector<Row>& rows);

}  // namespace penumbra
