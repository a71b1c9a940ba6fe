// A test report of LLVM's LNT, format version 2. Its server knows the metrics by scripts/lnt-penumbra.yaml.
#include <algorithm>

#include "harness/report/formats/exported_rows.h"
#include "scenes/error.h"

namespace penumbra {
namespace {

using nlohmann::json;

/// LNT's fields are all words.
json texts_of(const json& context, const std::vector<const char*>& fields) {
  json out = json::object();
  for (const char* field : fields) out[field] = context_text(context, field);
  return out;
}

/// "2026-11-26T10:50:21+00:00" as 2026.11.26.10.50.21: LNT orders runs by the numbers of their revision, and those of a
/// commit's hash have no order.
std::string revision_of(std::string date) {
  date = date.substr(0, 19);
  for (char& letter : date)
    if (letter < '0' || letter > '9') letter = '.';
  return date;
}

json test_of(const Row& row) {
  json test = {{"name", row.id.name()}};
  std::vector<double> seconds;
  for (const double ms : row.timing.frame_ms) seconds.push_back(1e-3 * ms);
  if (!seconds.empty()) test["execution_time"] = seconds;
  if (const auto error = row.score.truth_error()) test["error"] = *error;
  if (!row.id.external()) test["mem_bytes"] = row.facts.bytes.total();
  return test;
}

}  // namespace

Exported export_lnt(const std::vector<Results>& runs) {
  const Results& run = runs.front();
  const std::string date = context_text(run.context, "date");
  if (date.size() < 19) throw Error("its context has no date, by which LNT orders runs; measure it again");
  json machine = texts_of(run.context, {"num_cpus", "compiler", "flags", "cuda_device"});
  machine["name"] = context_text(run.context, "cpu_name");
  json about = texts_of(run.context, {"commit", "suite"});
  about["llvm_project_revision"] = revision_of(date);
  about["start_time"] = about["end_time"] = date.substr(0, 19);
  json tests = json::array();
  for (const Row* row : measured_rows(run.rows)) tests.push_back(test_of(*row));
  const json out = {{"format_version", "2"}, {"machine", machine}, {"run", about}, {"tests", tests}};
  return {json_text(out), unmeasured_text(run.rows)};
}

}  // namespace penumbra
