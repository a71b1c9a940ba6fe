// What a run prints at its end: one screen, the verdict first. The rest is in table.md.
#pragma once

#include <string>
#include <vector>

#include "harness/results/row.h"

namespace penumbra {

struct RunSummary {
  std::string suite, folder;
  std::string machine;  ///< "2 cores of ..."
  double seconds = 0.0;
};

/// At most so many columns, and 25 lines: per scene the best within 1, 3 and 10 %, and where there is room the rows
/// that no other beats; what failed or was skipped.
std::string make_run_screen(const RunSummary& summary, const std::vector<Row>& rows, int width);

}  // namespace penumbra
