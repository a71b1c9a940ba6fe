// results.json: rows under the context that they were measured in (docs/results.md).
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "harness/results/row.h"

namespace penumbra {

struct Results {
  nlohmann::json context = nlohmann::json::object();
  std::vector<Row> rows;
};

/// Rows of both; of two of the same name, that of `more`. Associative: parts of a run may be joined in any grouping.
std::vector<Row> merged(std::vector<Row> rows, const std::vector<Row>& more);

/// Writes DIR/results.json atomically. A good row with a time that is none (zero, negative, NaN) is written as failed,
/// without its times. Throws Error if the file cannot be written.
void write_results(const std::string& directory, const Results& results);

/// Reads a results.json, given as the file or as its folder, of this version or an older one; rows come in the order
/// they were written in. A row with a time that is none (zero, negative, null) has no times and the status
/// "failed: its times cannot be used: why". Throws Error, naming the file, what is wrong and what to do, if there is no
/// file, or it is none of penumbra's: foreign, cut off, damaged, with a row that stands twice, or too large.
Results read_results_path(const std::string& file_or_folder);

/// Reads DIR/results.json like read_results_path(); no rows if there is no file.
Results read_results(const std::string& directory);

}  // namespace penumbra
