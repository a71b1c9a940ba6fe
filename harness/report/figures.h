// What follows from a run's rows, as JSON for programs that draw it (docs/report.md).
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "harness/results/results_file.h"

namespace penumbra {

/// Per scene: ties, Pareto front, the cheapest within limits of error, speed-ups over the technique named `reference`
/// at equal error, times at errors and errors at times, scaling with its slopes, break-even points; and the published
/// figures that the run's suite asks for. A figure that cannot be had stands there with the reason.
nlohmann::json make_figures(const Results& results, const std::string& reference = "ray-traced");

}  // namespace penumbra
