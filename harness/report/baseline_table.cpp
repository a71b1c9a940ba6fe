#include <fmt/format.h>

#include "harness/report/markdown_table.h"
#include "harness/report/row_text.h"
#include "harness/report/tables.h"

namespace penumbra {

std::string make_baseline_table(const std::string& baseline, const std::vector<Row>& rows) {
  std::string text;
  for (const std::string& scene : scenes_of(rows)) {
    const std::vector<const Row*> good = good_rows(rows, scene);
    std::vector<std::string> columns = variant_columns();
    columns.insert(columns.end(), {"relative RMSE %", "SSIM", "FLIP"});
    MarkdownTable table(columns);
    for (const Row* row : good) {
      const auto at = row->score.errors.find(baseline);
      if (at == row->score.errors.end()) continue;
      const Errors& e = at->second.report.all;
      const auto optional = [](const std::optional<double>& v) { return v ? fmt::format("{:.4f}", *v) : ""; };
      std::vector<std::string> cells = variant_cells(*row, good);
      cells.insert(cells.end(), {percent_text(e.rel_rmse), optional(e.ssim), optional(e.flip)});
      table.add(cells);
    }
    if (!table.empty()) text += fmt::format("\n## {}: against the image of {}\n\n", scene, baseline) + table.text();
  }
  return text;
}

}  // namespace penumbra
