// Published times beside ours, as ratios within each table and subject.
#pragma once

#include <string>
#include <vector>

#include "harness/measure/suite.h"
#include "harness/results/row.h"

namespace penumbra {

/// Throws Error if a line that the suite names is not in results/published/NAME.csv (columns table, subject, variant,
/// value, unit), or its regular expression is none.
void check_published_times(const Suite& suite);

/// Markdown: published and measured time of every line, both over the first line of the same table and subject.
/// `row` of a line may find several rows (backends): one line each, compared with that of the same backend and threads.
std::string make_published_times_table(const Suite& suite, const std::vector<Row>& rows);

}  // namespace penumbra
