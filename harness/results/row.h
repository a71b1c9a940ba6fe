// Rows: what is known about one variant on one scene, and how it is written down.
#pragma once

#include <map>
#include <nlohmann/json.hpp>

#include "harness/measure/suite.h"
#include "harness/measure/timing.h"
#include "harness/results/metrics.h"

namespace penumbra {

struct RungErrors {
  ErrorReport report;
  double noise = 0.0;               ///< standard error of the rung, W m^-2 sr^-1
  std::optional<double> rel_noise;  ///< the same over the rung's RMS: relative RMSEs below it are ties
};

/// Errors over the frames of a motion, relative RMSE against each frame's truth; absent where that is black.
struct SequenceErrors {
  std::vector<std::optional<double>> rel_rmse;  ///< per frame
  std::vector<std::optional<double>> flicker;  ///< per pair of frames: RMS of the change of error, over the truth's RMS
  std::vector<double> coverage;     ///< per frame: share of the mesh's surface in its spheres; empty without spheres
  std::optional<double> rel_noise;  ///< of the truth, mean over frames; flicker below sqrt(2) of it is noise
  double carry_ms = 0.0;            ///< moving the spheres with the mesh, mean over frames
};

/// What one approximation of a technique adds to its error against rung `spheres` (Technique::approximations).
struct StepError {
  std::string name;
  double rel_rmse = 0.0;  ///< between the images before and after it, over the rung's RMS
  double share = 0.0;     ///< of the whole error: the step's projection onto it; shares add up to 1
};

struct Row {
  std::string scene, scene_key;  ///< key: hash of all that the scene's truth depends on, plus its spheres
  std::size_t spheres = 0, receivers = 0;
  std::string objective;  ///< that the spheres were fitted for; empty if they were given
  std::string technique, backend, instruction_set;
  Parameters parameters;
  int threads = 1;
  std::string status = "ok";  ///< "ok", "failed: why", "skipped: why"
  double prepare_ms = 0.0;
  long iterations = 0;
  std::vector<double> update_ms, shade_ms, frame_ms;  ///< one mean per repetition
  std::vector<StageSamples> stages;                   ///< of update and shade, in order of running
  double view_ms = -1.0;  ///< camera rays that found the receivers, not part of the frame; -1: no camera
  Footprint bytes;
  double parity = -1.0;                      ///< parity_with_scalar(); -1: is scalar
  std::map<std::string, RungErrors> errors;  ///< by rung
  std::optional<double> geometry;  ///< relative RMSE from rung cube to rung spheres; absent: no such rungs, or black
  std::optional<SequenceErrors> sequence;       ///< where the suite asks for it
  std::vector<StepError> steps;                 ///< where the suite asks for attribution and the technique knows
  std::map<std::string, std::size_t> counters;  ///< Technique::counters() after the scored frame

  bool ok() const { return status == "ok"; }
  std::string variant() const;  ///< technique, backend, parameters, threads
  std::string name() const;     ///< unique within a run
  double median_frame_ms() const;
  /// Sum of the medians of named stages; NaN if one of them is missing.
  double stages_ms(const std::vector<std::string>& names) const;
  std::optional<double> truth_error() const;  ///< relative RMSE against truth; absent if there is none or it is black
};

/// Google Benchmark's format: {"context": {...}, "benchmarks": [row, ...]}; our fields stand beside its own.
nlohmann::json to_json(const Row& row);
Row row_from_json(const nlohmann::json& json);

/// Writes DIR/results.json atomically.
void write_results(const std::string& directory, const nlohmann::json& context, const std::vector<Row>& rows);
/// Rows of an earlier run; empty if there is none. Throws Error if the file is damaged.
std::vector<Row> read_results(const std::string& directory);

/// "name=value ..." of a row's parameters that differ among rows of its technique; the others would only widen a table.
std::string telling_parameters(const Row& row, const std::vector<const Row*>& rows);

/// A relative error in percent for tables; "undefined" where it is 0 / 0.
std::string percent_text(const std::optional<double>& relative);
/// The same of one rung of a row; "" if the row has not been compared with it.
std::string rung_text(const Row& row, const std::string& rung);
/// The same of Row::geometry; "" if the row lacks one of the rungs.
std::string geometry_text(const Row& row);

/// Markdown: per scene, rows by frame time and by error against truth; Pareto-optimal rows marked.
std::string make_table(const std::vector<Row>& rows);

/// Markdown: errors over a motion's frames; empty if no row has any.
std::string make_sequence_table(const std::vector<Row>& rows);

/// Markdown: what each approximation adds; empty if no row knows.
std::string make_steps_table(const std::vector<Row>& rows);

/// Markdown: times of the sub-stages; empty if no row has any.
std::string make_stages_table(const std::vector<Row>& rows);

/// Markdown: errors against the suite's baseline; empty if no row has been compared with it.
std::string make_baseline_table(const std::string& baseline, const std::vector<Row>& rows);

/// Markdown: per scene, the cheapest row of each technique under 1, 3 and 10 % of error against truth.
std::string make_choice_table(const std::vector<Row>& rows);

/// Markdown: rows whose counters are not zero; empty if there is none.
std::string make_counters_table(const std::vector<Row>& rows);

/// Rows of one scene that no other row beats in both frame time and error (ties in error within the noise count as
/// equal). A row whose error is undefined neither is optimal nor beats another.
std::vector<bool> pareto_optimal(const std::vector<const Row*>& rows);

/// Writes a text file beside its place and renames it.
void write_atomically(const std::string& path, const std::string& text);

}  // namespace penumbra
