#include <fmt/format.h>

#include <cmath>

#include "harness/report/markdown_table.h"
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
    std::vector<std::string> columns = variant_columns();
    columns.insert(columns.end(), {"view", "frame"});
    columns.insert(columns.end(), names.begin(), names.end());
    MarkdownTable table(columns);
    for (const Row* row : good) {
      if (row->timing.stages.empty()) continue;
      std::vector<std::string> cells = variant_cells(*row, good);
      cells.push_back(row->timing.view_ms < 0 ? "" : fmt::format("{:.2f}", row->timing.view_ms));
      cells.push_back(fmt::format("{:.2f}", row->timing.median_frame_ms()));
      for (const std::string& name : names) {
        const double ms = row->timing.stages_ms({name});
        cells.push_back(std::isnan(ms) ? "" : fmt::format("{:.2f}", ms));
      }
      table.add(cells);
    }
    text += fmt::format(
                "\n## {}: stages\n\nMedian ms of the named parts of update and shade; `view`: camera rays, not part of "
                "the frame.\n\n",
                scene) +
            table.text();
  }
  return text;
}

}  // namespace penumbra
