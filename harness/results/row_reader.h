// Rows out of results.json. Fast, since a comparison reads tens of thousands of them twice.
#pragma once

#include <simdjson.h>

#include "harness/results/row.h"

namespace penumbra {

/// What to_json(Row) has written; without "samples", a row without times of repetitions. Throws Error naming the field
/// that is missing or of another type.
Row row_from(const simdjson::dom::element& json);

/// Fields of an object. All throw Error naming the field if it is missing or of another type.
simdjson::dom::element field(const simdjson::dom::element& object, const char* name);
double number_of(const simdjson::dom::element& object, const char* name);
std::string text_of(const simdjson::dom::element& object, const char* name);

}  // namespace penumbra
