// Two programs measured in one session, row by row in turn, so that whatever the machine does, it does to both.
#pragma once

#include <string>

#include "harness/compare/comparison.h"
#include "harness/measure/progress.h"

namespace penumbra {

struct SideBySide {
  std::string programs[2];  ///< base and new
  std::string suite;
  std::string filter = ".*";
  std::string directory;   ///< for the results of both: base/ and new/ below it
  int threads = 0;         ///< of parallel backends; 0: the suite's
  double budget_s = 20.0;  ///< of measuring, for each row that both have
  unsigned seed = 1;       ///< of the order of rows and sides
  Thresholds thresholds;
};

struct TwoResults {
  Results base, next;
};

/// Each program runs the suite once, which scores its rows and saves its images, and is then started over and over
/// again: a launch prepares the rows that are not certain yet and times each a few times, in turn with the other
/// program. A row is certain once the interval of its change, corrected for all rows and for looking again and again,
/// lies on one side of every threshold. Both results.json are written. Throws Error if a program cannot be run or
/// nothing is in common, Interrupted with what there is on disk.
TwoResults measure_side_by_side(const SideBySide& plan, Progress& progress);

/// How often at most a row's samples are looked at, after so many launches each.
inline constexpr int launches_at_looks[] = {5, 8, 12, 18, 27, 40};

}  // namespace penumbra
