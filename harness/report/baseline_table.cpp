#include <fmt/format.h>

#include "harness/report/row_text.h"
#include "harness/report/tables.h"

namespace penumbra {

std::string make_baseline_table(const std::string& baseline, const std::vector<Row>& rows) {
  std::string text;
  for (const std::string& scene : scenes_of(rows)) {
    const std::vector<const Row*> good = good_rows(rows, scene);
    std::string lines;
    for (const Row* row : good) {
      const auto at = row->score.errors.find(baseline);
      if (at == row->score.errors.end()) continue;
      const Errors& e = at->second.report.all;
      const auto optional = [](const std::optional<double>& v) { return v ? fmt::format("{:.4f}", *v) : ""; };
      lines += fmt::format("| {} | {} | {} | {} |\n", variant_columns(*row, good), percent_text(e.rel_rmse),
                           optional(e.ssim), optional(e.flip));
    }
    if (!lines.empty())
      text += fmt::format(
                  "\n## {}: against the image of {}\n\n| technique | backend | parameters | threads | relative RMSE % "
                  "| SSIM | "
                  "FLIP |\n|---|---|---|---|---|---|---|\n",
                  scene, baseline) +
              lines;
  }
  return text;
}

}  // namespace penumbra
