#include <fmt/format.h>

#include <algorithm>

#include "harness/report/row_text.h"
#include "harness/report/tables.h"

namespace penumbra {
namespace {

/// The cheapest timed row of a technique whose error against truth is defined and within the limit.
const Row* cheapest_within(double limit, const std::string& technique, const std::vector<const Row*>& rows) {
  const Row* best = nullptr;
  for (const Row* row : rows)
    if (row->id.technique == technique && row->timing.timed() && row->score.truth_error() &&
        *row->score.truth_error() <= limit && (!best || row->timing.median_frame_ms() < best->timing.median_frame_ms()))
      best = row;
  return best;
}

}  // namespace

std::string make_choice_table(const std::vector<Row>& rows) {
  constexpr double limits[] = {0.01, 0.03, 0.1};
  std::string text;
  for (const std::string& scene : scenes_of(rows)) {
    const std::vector<const Row*> good = good_rows(rows, scene);
    std::vector<std::string> techniques;
    for (const Row* row : good)
      if (row->timing.timed()) add_distinct(row->id.technique, techniques);
    if (techniques.size() < 2) continue;
    text += fmt::format("\n## {}: the cheapest row of each technique within an error\n\n", scene);
    if (std::none_of(good.begin(), good.end(), [](const Row* row) { return row->score.truth_error().has_value(); })) {
      text += "None: the truth is black, and relative errors are undefined.\n";
      continue;
    }
    text += "| technique |";
    for (const double limit : limits) text += fmt::format(" {:g} % |", 100.0 * limit);
    text += "\n|---|---|---|---|\n";
    for (const std::string& technique : techniques) {
      text += "| " + technique + " |";
      for (const double limit : limits) {
        const Row* best = cheapest_within(limit, technique, good);
        text += best
                    ? fmt::format(" {:.2f} ms, {:.2f} %, {} {} |", best->timing.median_frame_ms(),
                                  100.0 * *best->score.truth_error(), best->id.backend, telling_parameters(*best, good))
                    : " |";
      }
      text += "\n";
    }
  }
  return text;
}

}  // namespace penumbra
