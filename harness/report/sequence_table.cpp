#include <fmt/format.h>

#include <algorithm>

#include "harness/report/markdown_table.h"
#include "harness/report/row_text.h"
#include "harness/report/tables.h"
#include "harness/results/statistics.h"

namespace penumbra {

std::string make_sequence_table(const std::vector<Row>& rows) {
  const auto largest = [](const std::vector<std::optional<double>>& v) {  // an absent one is less than all others
    return v.empty() ? std::nullopt : *std::max_element(v.begin(), v.end());
  };
  MarkdownTable table({"scene", "variant", "spheres", "frames", "mean %", "worst %", "flicker %", "truth's noise %",
                       "least surface coverage %", "carry ms", "update ms", "shade ms", "frame ms"});
  for (const Row& row : rows) {
    if (!row.ok() || !row.score.sequence) continue;
    const SequenceErrors& s = *row.score.sequence;
    const std::string covered =
        s.coverage.empty() ? ""
                           : fmt::format("{:.2f}", 100.0 * *std::min_element(s.coverage.begin(), s.coverage.end()));
    table.add({row.id.scene, variant_label(row, good_rows(rows, row.id.scene)), spheres_text(row.id),
               std::to_string(s.rel_rmse.size()), mean_or_tie(s.rel_rmse, s.floor()), percent_text(largest(s.rel_rmse)),
               mean_or_tie(s.flicker, s.flicker_floor()), percent_text(s.rel_noise), covered,
               fmt::format("{:.3f}", s.carry_ms), median_text(row.timing.update_ms), median_text(row.timing.shade_ms),
               milliseconds_text(row.timing)});
  }
  if (table.empty()) return "";
  return "\n## Over all frames\n\nRelative RMSE in percent against each frame's truth, over the frames whose truth is "
         "not black; `flicker`: RMS of the change of error from frame to frame; `(tie)`: below what the noise of the "
         "truth alone amounts to; `carry`: moving the spheres with the mesh, before any technique.\n\n" +
         table.text();
}

}  // namespace penumbra
