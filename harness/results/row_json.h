// The one place that knows how a row is written down (docs/suites.md).
#pragma once

#include <nlohmann/json.hpp>

#include "harness/results/row.h"

namespace penumbra {

/// An object of numbers and words.
nlohmann::json to_json(const Values& values);

/// All of a row, with medians of its times and, in "samples", those of every repetition. What is undefined is null.
nlohmann::json to_json(const Row& row);
/// What to_json(Row) has written. Throws Error naming the field that is missing or of another type.
Row row_from_json(const std::string& text);

}  // namespace penumbra
