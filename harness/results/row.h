// A row: what is known about one variant on one scene. Plain data; knows neither techniques nor the registry.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "harness/results/metrics.h"
#include "scenes/pattern.h"
#include "scenes/values.h"

namespace penumbra {

/// Backend of what ran outside of this program: all that is known of it is its image, and perhaps its time.
inline constexpr const char* external_backend = "external";

/// What was measured.
struct RowIdentity {
  std::string scene;
  std::size_t spheres = 0, receivers = 0;
  std::string objective;      ///< that the spheres were fitted for; empty if they were given
  bool reads_spheres = true;  ///< does the variant look at the spheres? If not, their number says nothing about the row
  std::string technique, backend;
  Values parameters, defaults;  ///< all of them, and what they are if nobody asks for anything else
  int threads = 1;              ///< 0: not known

  bool external() const { return backend == external_backend; }
  /// Technique, backend, the parameters that are not at their defaults, and threads if they are known.
  std::string variant() const;
  /// Unique within a run and at most `longest_name` bytes. No value that is a default stands in it, so a parameter that
  /// a technique gains later does not change it; a name that would be too long ends in a hash of the whole.
  std::string name() const;
  /// The name with all parameters, however long: it tells a value from another even when the default itself changes.
  std::string full_name() const;
  static constexpr std::size_t longest_name = 192;  ///< 200 with "_median" or another aggregate's suffix behind
};

/// Is a regular expression found in the row's name, or in the name with all parameters?
bool is_in(const Pattern& pattern, const RowIdentity& id);

/// A named sub-stage (Technique::stages): one mean per repetition.
struct StageSamples {
  std::string name;
  std::vector<double> ms;
};

struct Timing {
  double prepare_ms = -1.0;                           ///< -1: not known
  long iterations = 0;                                ///< frames per repetition
  std::vector<double> update_ms, shade_ms, frame_ms;  ///< one mean per repetition
  std::vector<StageSamples> stages;                   ///< of update and shade, in order of running
  std::vector<double> cpu_ms;  ///< of a frame, of all threads of the process together; empty: not known
  std::vector<int> launch;     ///< by repetition, the number of the process that it ran in; empty: one for all
  double view_ms = -1.0;       ///< camera rays that found the receivers, not part of the frame; -1: no camera
  /// Wall time of an external technique's command, with its start and all that it loads: no frame's time. -1: none.
  double command_ms = -1.0;

  bool timed() const { return !frame_ms.empty(); }
  double median_frame_ms() const;  ///< NaN if no frame was timed
  double frame_spread_ms() const;  ///< half the interquartile range of the repetitions
  /// Sum of the medians of named stages; NaN if one of them is missing.
  double stages_ms(const std::vector<std::string>& names) const;
};

struct RungErrors {
  ErrorReport report;
  double noise = 0.0;               ///< standard error of the rung, W m^-2 sr^-1
  std::optional<double> rel_noise;  ///< the same over the rung's RMS

  /// Is the error what an exact image would have? Its expectation is the reference's own noise, so up to sqrt(2) of
  /// that, the error has no more in it than the noise (they add in quadrature).
  bool tie() const;
  /// The relative RMSE up to which errors are ties; 0 if there is none.
  double floor() const;
};

/// Errors over the frames of a motion, relative RMSE against each frame's truth; absent where that is black.
struct SequenceErrors {
  std::vector<std::optional<double>> rel_rmse;  ///< per frame
  std::vector<std::optional<double>> flicker;  ///< per pair of frames: RMS of the change of error, over the truth's RMS
  std::vector<double> coverage;     ///< per frame: share of the mesh's surface in its spheres; empty without spheres
  std::optional<double> rel_noise;  ///< of the truth, mean over frames
  double carry_ms = 0.0;            ///< moving the spheres with the mesh, mean over frames

  /// Up to these, errors and flicker are ties: sqrt(2) of the noise, and of the noise of a difference of two frames.
  double floor() const;
  double flicker_floor() const;
};

/// What one approximation of a technique adds to its error against rung `spheres` (Technique::approximations).
struct StepError {
  std::string name;
  double rel_rmse = 0.0;  ///< between the images before and after it, over the rung's RMS
  double share = 0.0;     ///< of the whole error: the step's projection onto it; shares add up to 1
};

struct Score {
  double parity = -1.0;                      ///< parity_with_scalar(); -1: is scalar
  std::map<std::string, RungErrors> errors;  ///< by rung
  std::optional<double> geometry;  ///< relative RMSE from rung cube to rung spheres; absent: no such rungs, or black
  std::optional<SequenceErrors> sequence;  ///< where the suite asks for it
  std::vector<StepError> steps;            ///< where the suite asks for attribution and the technique knows

  std::optional<double> truth_error() const;  ///< relative RMSE against truth; absent if there is none or it is black
};

struct Facts {
  std::string scene_key;  ///< hash of all that the scene's truth depends on, plus its spheres
  std::string key;  ///< hash of all that the row depends on but the program and the machine: see measurement_key()
  std::string instruction_set;
  struct Bytes {
    std::size_t tables = 0, per_scene = 0, per_frame = 0;
    std::size_t total() const { return tables + per_scene + per_frame; }
  } bytes;                                      ///< Technique::footprint()
  std::map<std::string, std::size_t> counters;  ///< Technique::counters() after the scored frame
  std::string image;  ///< of the scored frame: path below the folder of results, without .exr, .png or .error.png
};

struct Row {
  RowIdentity id;
  Timing timing;
  Score score;
  Facts facts;
  std::string status = "ok";  ///< "ok", "failed: why", "skipped: why"

  bool ok() const { return status == "ok"; }
  bool failed() const { return status.starts_with("failed"); }
  bool skipped() const { return status.starts_with("skipped"); }
};

}  // namespace penumbra
