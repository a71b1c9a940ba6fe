// The one place that knows how a row is written down (docs/suites.md).
#pragma once

#include <nlohmann/json.hpp>

#include "harness/results/row.h"

namespace penumbra {

/// An entry of Google Benchmark's format; our fields stand beside its own. What is undefined is null.
nlohmann::json to_json(const Row& row);
/// Throws nlohmann::json::exception if a field is missing or of another type.
Row row_from_json(const nlohmann::json& json);

}  // namespace penumbra
