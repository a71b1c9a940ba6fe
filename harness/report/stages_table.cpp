#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "harness/report/row_text.h"
#include "harness/report/tables.h"

namespace penumbra {

std::string make_stages_table(const std::vector<Row>& rows) {
  std::string text;
  for (const std::string& scene : scenes_of(rows)) {
    const std::vector<const Row*> good = good_rows(rows, scene);
    std::vector<std::string> names;
    for (const Row* row : good)
      for (const StageSamples& stage : row->timing.stages) add_distinct(stage.name, names);
    if (names.empty()) continue;
    text += fmt::format(
        "\n## {}: stages\n\nMedian ms of the named parts of update and shade; `view`: camera rays, not part of the "
        "frame.\n\n| technique | backend | parameters | threads | view | frame |",
        scene);
    std::string rule = "|---|---|---|---|---|---|";
    for (const std::string& name : names) text += " " + name + " |", rule += "---|";
    text += "\n" + rule + "\n";
    for (const Row* row : good) {
      if (row->timing.stages.empty()) continue;
      text += fmt::format("| {} | {} | {:.2f} |", variant_columns(*row, good),
                          row->timing.view_ms < 0 ? "" : fmt::format("{:.2f}", row->timing.view_ms),
                          row->timing.median_frame_ms());
      for (const std::string& name : names) {
        const double ms = row->timing.stages_ms({name});
        text += std::isnan(ms) ? " |" : fmt::format(" {:.2f} |", ms);
      }
      text += "\n";
    }
  }
  return text;
}

}  // namespace penumbra
