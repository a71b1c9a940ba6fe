// Runs a suite: plan, do the jobs, write rows and tables.
#pragma once

#include <string>

#include "harness/measure/suite.h"

namespace penumbra {

struct RunOptions {
  std::string directory;      ///< results.json, table.md and images/ go here
  std::string filter = ".*";  ///< regular expression searched in row names
  int repetitions = 0;        ///< 0: the suite's
  bool resume = false;        ///< keep good rows of an earlier run with the same inputs, program and machine
};

/// Returns the exit code: 0 good, 1 some row failed, all were skipped, or results could not be written, 130
/// interrupted. Throws Error for wrong input, and if another run has the directory, before anything in it is touched.
/// Rows are on disk within a second of being finished, and all of them after every scene.
int run_suite(const Suite& suite, const Registry& registry, const RunOptions& options);

}  // namespace penumbra
