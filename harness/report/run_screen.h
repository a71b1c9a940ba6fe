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

/// "bunny-city", "torus-knot 64 spheres visibility=raster": a row in a few words, among the others of its scene.
std::string label_of(const Row& row, const std::vector<const Row*>& rows);

/// The best row within an error: the fastest; of rows that are as fast within the noise of both, the nearest to the
/// truth. Null if none is within.
const Row* best_within(double limit, const std::vector<const Row*>& rows);

/// At most 100 columns and 25 lines: per scene the best within 1, 3 and 10 %, and where there is room the rows that no
/// other beats; what failed or was skipped.
std::string make_run_screen(const RunSummary& summary, const std::vector<Row>& rows);

}  // namespace penumbra
