// The published figures that a run's suite asks for, beside its rows, as JSON.
#pragma once

#include <nlohmann/json.hpp>

#include "harness/results/results_file.h"

namespace penumbra {

/// One table, or none: every published figure, with each row that it can be held against. What the context asks for and
/// cannot be had is a warning.
nlohmann::json make_published_figures(const Results& results);

}  // namespace penumbra
