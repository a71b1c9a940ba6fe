#include <fmt/format.h>

#include "harness/report/markdown_table.h"
#include "harness/report/row_text.h"
#include "harness/report/tables.h"

namespace penumbra {

std::string make_steps_table(const std::vector<Row>& rows) {
  MarkdownTable table({"scene", "variant", "spheres", "geometry %", "steps", "all of them %", "truth %"});
  for (const Row& row : rows) {
    if (!row.ok() || row.score.steps.empty()) continue;
    std::string steps;
    for (const StepError& step : row.score.steps)
      steps += fmt::format("{}{} {:.3g} ({:.0f})", steps.empty() ? "" : ", ", step.name, 100.0 * step.rel_rmse,
                           100.0 * step.share);
    table.add({row.id.scene, variant_label(row, good_rows(rows, row.id.scene)), spheres_text(row.id),
               geometry_text(row), steps, rung_text(row, "spheres"), rung_or_tie(row, "truth")});
  }
  if (table.empty()) return "";
  return "\n## What each approximation adds\n\nFrom rung `spheres` to the technique's image, one approximation after "
         "the other: relative RMSE of the step in percent, and in brackets its share of the whole error (shares add "
         "up to 100; a negative one makes up for others). `geometry`: from rung cube to rung spheres.\n\n" +
         table.text();
}

std::string make_counters_table(const std::vector<Row>& rows) {
  std::string text;
  for (const Row& row : rows) {
    std::string counts;
    for (const auto& [name, count] : row.facts.counters)
      if (count > 0) counts += fmt::format("{}{} {}", counts.empty() ? "" : ", ", count, name);
    if (row.ok() && !counts.empty())
      text += fmt::format("- {}, {}: {}\n", row.id.scene, short_label(row, good_rows(rows, row.id.scene)), counts);
  }
  return text.empty() ? "" : "\n## Counted while shading\n\n" + text;
}

}  // namespace penumbra
