// One row on the screen.
#pragma once

#include <string>
#include <vector>

#include "harness/results/row.h"

namespace penumbra {

/// Every metric of a row, by rung and by region, and where it stands among the rows of its scene: those that are ok, by
/// error against truth, at most ten. Lines of at most 100 columns.
std::string make_score_text(const Row& row, const std::vector<Row>& rows);

}  // namespace penumbra
