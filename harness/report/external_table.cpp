#include <fmt/format.h>

#include "harness/report/row_text.h"
#include "harness/report/tables.h"

namespace penumbra {

std::string make_external_table(const std::vector<Row>& rows) {
  std::string text;
  for (const Row& row : rows) {
    if (row.timing.command_ms < 0.0) continue;
    if (text.empty())
      text =
          "\n## Commands of external techniques\n\n`command s`: wall time of the whole command, with its start and all "
          "that it loads; frame times are those that it printed.\n\n| scene | technique | command s | frames | frame "
          "ms "
          "| |\n|---|---|---|---|---|---|\n";
    text += fmt::format("| {} | {} | {:.3f} | {} | {} | {} |\n", row.id.scene, row.id.technique,
                        1e-3 * row.timing.command_ms, row.timing.frame_ms.size(), milliseconds_text(row.timing),
                        row.ok() ? "" : row.status);
  }
  return text;
}

}  // namespace penumbra
