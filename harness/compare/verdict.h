// Two measurements of one row: which is faster, which is nearer to the truth, and how sure that is.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "harness/compare/significance.h"
#include "harness/results/row.h"

namespace penumbra {

/// What counts as a regression. Changes below are told, and are none.
struct Thresholds {
  double slower = 0.05;  ///< share by which a frame may take longer
  double error = 0.05;   ///< share by which an error may grow
};

/// Share of comparisons of equals that may find any difference.
inline constexpr double false_alarms = 0.05;

struct TimeComparison {
  enum class Verdict { none, faster, same, slower, unknown, not_comparable };
  Verdict verdict = Verdict::none;  ///< none: neither has a time
  double base_ms = 0.0, next_ms = 0.0;
  double ratio = 1.0;        ///< next over base
  Interval interval;         ///< of the ratio, 95 %
  double probability = 1.0;  ///< of a difference like this among equals; after Holm's correction over all rows
  bool paired = false;       ///< measured side by side
  bool identical = false;    ///< the very same samples
  bool regressed = false;
  std::string why;  ///< for unknown and not_comparable
};

/// The error that changed most, by its rung ("truth", "frames": mean over a sequence).
struct ErrorComparison {
  enum class Verdict { none, better, same, worse, unknown };
  Verdict verdict = Verdict::none;  ///< none: neither has errors
  std::string rung;
  std::optional<double> base, next;  ///< relative RMSE; absent where the rung is black
  double factor = 1.0;               ///< next over base, both at least the floor that the reference's noise sets
  bool regressed = false;
  std::string why;
};

/// Do samples of two rows of one session belong to each other, one by one?
bool paired(const Timing& base, const Timing& next);

/// Changes of time, as logarithms of next over base, one for each pair of processes: the median of their samples'
/// pairs. Samples within a process share what only differs between processes (where memory lies), so they are no
/// evidence against that; pairs of processes are.
std::vector<double> changes_of_launches(const Timing& base, const Timing& next);

/// Measures without a verdict: ratio, interval and probability, the latter not corrected for other rows yet. `looks`:
/// for two that were measured side by side, how often they are looked at to decide whether to go on; 0 for separate
/// runs. A row that cannot be used says why.
TimeComparison measure_change(const Timing& base, const Timing& next, int looks);

/// Gives the verdict, once `probability` is corrected.
void judge(const Thresholds& thresholds, TimeComparison& change);

/// Errors are deterministic, but their reference is not: a change counts if it is beyond rounding and beyond what the
/// reference's noise can make of it. Against the same reference, noise n of N receivers changes the difference of two
/// RMSEs by at most 2 n / sqrt(N) (standard error), of which four count; against two references, the larger of
/// their noises counts. Errors below a floor (RungErrors::floor) are as large as that.
ErrorComparison compare_errors(const Row& base, const Row& next, const Thresholds& thresholds);
/// What tells most of all pairs, for rows that stand in a run more than once.
ErrorComparison compare_errors(const std::vector<const Row*>& base, const std::vector<const Row*>& next,
                               const Thresholds& thresholds);

}  // namespace penumbra
