// Runs a suite: check, time, score, write.
#pragma once

#include <string>

#include "harness/measure/suite.h"

namespace penumbra {

struct RunOptions {
  std::string directory;      ///< results.json, table.md and images/ go here
  std::string filter = ".*";  ///< regular expression searched in row names
  int repetitions = 0;        ///< 0: the suite's
  bool resume = false;        ///< keep good rows of an earlier run with the same inputs
};

/// Returns the exit code: 0 good, 1 some row failed or results could not be written, 130 interrupted. Throws Error for
/// wrong input before anything in the directory is touched. After every scene the results are on disk; what goes wrong
/// on one scene makes its rows fail, and the run goes on.
int run_suite(const Suite& suite, const Registry& registry, const RunOptions& options);

/// RMSE between a variant and its scalar twin over the RMS of the twin's image, on at most 32 x 32 of the scene's
/// receivers; 0 for scalar itself or if there is no twin. An image darker than a hundredth of what would arrive
/// (light_scale()) is compared as if it were that bright: where light cancels, only round-off is left to differ.
double parity_with_scalar(const Registry& registry, const Entry& entry, const Parameters& parameters,
                          const Scene& scene);

/// Every stride-th receiver of a scene, so that at most `edge` x `edge` (or edge^2 in a row) are left.
Scene thinned(const Scene& scene, int edge);

}  // namespace penumbra
