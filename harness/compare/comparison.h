// Two runs, row by row.
#pragma once

#include <string>
#include <vector>

#include "harness/compare/verdict.h"
#include "harness/results/results_file.h"

namespace penumbra {

struct ComparedRow {
  std::string name;  ///< of the newer row
  const Row *base = nullptr, *next = nullptr;
  TimeComparison time;
  ErrorComparison error;
  std::string
      broken;  ///< for a row that one of the two did not measure: "failed now: why", "skipped now: why", "mended"

  double most_ratio = 1.0;  ///< of times, up to which a row has not regressed

  bool regressed() const;
  /// No verdict on the time, but it has not regressed.
  bool perhaps_faster() const;
  /// Is there a regression that cannot be ruled out?
  bool unknown() const;
  bool changed() const;
};

/// Both runs outlive it.
struct Comparison {
  std::vector<ComparedRow> rows;            ///< what tells most first
  std::vector<std::string> added, removed;  ///< names of rows without a partner
  std::size_t unmeasured = 0;               ///< rows that neither of the two measured
  std::vector<std::string> notes;           ///< what is odd about the two as a whole
  bool side_by_side = false;
  Thresholds thresholds;

  /// 0 fine, 1 a regression, 2 nothing in common, 3 none, but something is unknown, not comparable or removed, or
  /// nothing was measured.
  int exit_code() const;
};

/// Rows are partners if scene, spheres, technique, backend, threads and all parameters that both know are the same, and
/// parameters that only one knows have their default. A row that stands twice in one run is compared with nothing.
/// Times are not comparable if the machine, the compiler, its flags or the scene's content (which is that of its truth)
/// differ; errors always are.
Comparison compare(const Results& base, const Results& next, const Thresholds& thresholds);

/// What differs between the machines and builds of two runs, in words; empty if times may be compared.
std::string why_times_differ(const nlohmann::json& base, const nlohmann::json& next);

/// Identity of a session in which two programs were measured side by side, and how often it looked at its rows.
nlohmann::json session_context(const std::string& identity, int looks);

}  // namespace penumbra
