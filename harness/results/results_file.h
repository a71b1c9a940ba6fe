// results.json: rows under the context that they were measured in.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "harness/results/row.h"

namespace penumbra {

/// Google Benchmark's format: {"context": {...}, "benchmarks": [row, ...]}.
struct Results {
  nlohmann::json context = nlohmann::json::object();
  std::vector<Row> rows;
};

/// Rows of both; of two of the same name, that of `more`. Associative, so that parts of a run may be joined in any
/// grouping.
std::vector<Row> merged(std::vector<Row> rows, const std::vector<Row>& more);

/// Writes DIR/results.json atomically. Throws Error if it cannot be written.
void write_results(const std::string& directory, const Results& results);
/// Empty if there is no file. Throws Error if the file is damaged.
Results read_results(const std::string& directory);

/// Writes a text file beside its place and renames it. Throws Error if it cannot be written.
void write_atomically(const std::string& path, const std::string& text);

}  // namespace penumbra
