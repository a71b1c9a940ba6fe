#include <fmt/format.h>

#include <algorithm>

#include "harness/report/markdown_table.h"
#include "harness/report/row_text.h"
#include "harness/report/tables.h"
#include "harness/results/derived.h"
#include "harness/results/text.h"

namespace penumbra {
namespace {

std::vector<const Row*> rows_of(const std::string& technique, const std::vector<const Row*>& rows) {
  std::vector<const Row*> own;
  for (const Row* row : rows)
    if (row->id.technique == technique) own.push_back(row);
  return own;
}

std::string choice_text(const Row& row, bool unbeaten, const std::vector<const Row*>& rows) {
  const std::string mark = unbeaten ? "**" : "", label = telling_parameters(row, rows);
  return fmt::format("{}{} ms{}, {} %, {}{}{}", mark, three_digits(row.timing.median_frame_ms()), mark,
                     rung_or_tie(row, "truth"), row.id.backend, label.empty() ? "" : " ", label);
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
    std::vector<std::string> columns = {"technique"};
    std::vector<std::vector<const Row*>> found;  // by limit and technique
    for (const double limit : limits) {
      columns.push_back(fmt::format("{:g} %", 100.0 * limit));
      std::vector<const Row*>& best = found.emplace_back();
      for (const std::string& technique : techniques) best.push_back(best_within(limit, rows_of(technique, good)));
    }
    MarkdownTable table(columns);
    for (std::size_t t = 0; t < techniques.size(); ++t) {
      std::vector<std::string> cells = {techniques[t]};
      for (const std::vector<const Row*>& best : found) {
        const bool unbeaten = best[t] && std::none_of(best.begin(), best.end(),
                                                      [&](const Row* row) { return row && faster(*row, *best[t]); });
        cells.push_back(best[t] ? choice_text(*best[t], unbeaten, good) : "");
      }
      if (std::any_of(found.begin(), found.end(), [&](const auto& best) { return best[t] != nullptr; }))
        table.add(cells);
    }
    text += table.empty() ? "None is within 10 %.\n"
                          : "Bold: no other technique is faster by more than the noise of both.\n\n" + table.text();
  }
  return text;
}

}  // namespace penumbra
