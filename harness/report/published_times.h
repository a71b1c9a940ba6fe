// Published times beside ours, as ratios within each table and subject.
#pragma once

#include <string>
#include <vector>

#include "harness/report/published.h"
#include "harness/results/published_time.h"
#include "harness/results/row.h"

namespace penumbra {

/// What a suite asks for.
struct PublishedTimes {
  std::string suite, file;  ///< names: of the suite, for messages, and of results/published/FILE.csv
  std::vector<PublishedTime> times;
};

/// Throws Error if a time is not in the file (columns table, subject, variant, value, unit), or its regular expression
/// is none.
void check_published_times(const PublishedTimes& asked);

/// Every time that is asked for, in that order, with each row that it is compared with, or alone; behind them the rest
/// of the file. `row` of a time may find several rows (backends): relative figures are over that of the same backend
/// and threads. Throws like check_published_times().
std::vector<PublishedFigure> published_times_beside(const PublishedTimes& asked, const std::vector<Row>& rows);

/// Markdown: every published time and what was measured, both over the first of the same table and subject. `row` of
/// one may find several rows (backends): one line each, compared with that of the same backend and threads.
std::string make_published_times_table(const PublishedTimes& asked, const std::vector<Row>& rows);

}  // namespace penumbra
