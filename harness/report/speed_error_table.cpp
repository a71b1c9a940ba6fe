#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <map>

#include "harness/report/markdown_table.h"
#include "harness/report/row_text.h"
#include "harness/report/tables.h"
#include "harness/results/derived.h"
#include "harness/results/statistics.h"

namespace penumbra {

namespace {

std::string optional_number(const std::optional<double>& value) {
  return value ? fmt::format("{:.4f}", *value) : "";
}

/// Cells `signed`, `negative`, `PSNR`, `SSIM` and `FLIP`.
std::vector<std::string> truth_cells(const Row& row) {
  const auto at = row.score.errors.find("truth");
  if (at == row.score.errors.end()) return std::vector<std::string>(5);
  const Errors& e = at->second.report.all;
  return {e.receivers > 0 ? fmt::format("{:+.2g}", e.mean_signed) : "undefined",
          e.negative > 0 ? std::to_string(e.negative) : "", e.psnr ? fmt::format("{:.1f}", *e.psnr) : "undefined",
          optional_number(e.ssim), optional_number(e.flip)};
}

/// 1 for the row nearest to the truth; rows that are equally near share a rank. Where relative errors are undefined,
/// the RMSE decides.
std::string rank_by_error(const Row& row, const std::vector<const Row*>& rows) {
  const auto truth = [](const Row& r) { return r.score.errors.find("truth"); };
  if (truth(row) == row.score.errors.end()) return "";
  const auto is_nearer = [&](const Row* other) {
    if (truth(*other) == other->score.errors.end()) return false;
    if (row.score.truth_error() || other->score.truth_error()) return nearer(*other, row);
    return truth(*other)->second.report.all.rmse < truth(row)->second.report.all.rmse;
  };
  return std::to_string(1 + std::count_if(rows.begin(), rows.end(), is_nearer));
}

/// Rows without a time come last.
double frame_ms(const Row& row) {
  return row.timing.timed() ? row.timing.median_frame_ms() : std::numeric_limits<double>::infinity();
}

/// In order of frame time.
std::string table_of(std::vector<const Row*> rows) {
  MarkdownTable table({"",           "technique", "backend",   "parameters", "threads", "spheres",
                       "prepare ms", "update ms", "shade ms",  "frame ms",   "MiB",     "truth %",
                       "rank",       "cube %",    "spheres %", "geometry %", "13x13 %", "signed",
                       "negative",   "PSNR",      "SSIM",      "FLIP"});
  std::stable_sort(rows.begin(), rows.end(), [](const Row* a, const Row* b) { return frame_ms(*a) < frame_ms(*b); });
  const std::vector<bool> optimal = pareto_optimal(rows);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const Row& r = *rows[i];
    std::vector<std::string> cells = {optimal[i] ? "P" : ""};
    for (const std::string& cell : variant_cells(r, rows)) cells.push_back(cell);
    if (!r.facts.instruction_set.empty()) cells[2] += " " + r.facts.instruction_set;
    cells.insert(cells.end(),
                 {prepare_text(r.timing), median_text(r.timing.update_ms), median_text(r.timing.shade_ms),
                  milliseconds_text(r.timing), mebibytes_text(r), rung_or_tie(r, "truth"), rank_by_error(r, rows),
                  rung_or_tie(r, "cube"), rung_or_tie(r, "spheres"), geometry_text(r), rung_or_tie(r, "13x13")});
    for (const std::string& cell : truth_cells(r)) cells.push_back(cell);
    table.add(cells);
  }
  return table.text();
}

/// Why rows were not measured, each reason once.
std::string reasons(const std::vector<const Row*>& rows) {
  std::vector<std::string> order;
  std::map<std::string, std::string> labels;  // by status
  for (const Row* row : rows) {
    add_distinct(row->status, order);
    std::string& all = labels[row->status];
    all += (all.empty() ? "" : ", ") + short_label(*row, rows);
  }
  std::string text;
  for (const std::string& status : order) text += fmt::format("- {}: {}\n", labels[status], status);
  return text;
}

}  // namespace

std::string make_table(const std::vector<Row>& rows) {
  std::string text =
      "\nErrors are relative RMSE in percent against each rung of the reference ladder; `(tie)`: no more than the "
      "reference's own noise makes of an exact image; `rank`: 1 is nearest to the truth. Frame times are medians with "
      "half the interquartile range of the repetitions; where these ranges overlap, times are ties. `P`: no other row "
      "of the scene is faster and not farther from the truth, or nearer and not slower.\n`signed`: mean of image - "
      "truth in W m^-2 sr^-1 (positive leaks light, negative over-darkens); `negative`: channel values below 0, left "
      "as "
      "they are. PSNR, SSIM and FLIP are against truth. `geometry`: rung spheres against rung cube, what the sphere "
      "set "
      "alone adds. Columns that no row has anything to say in are left out.\n";
  for (const std::string& scene : scenes_of(rows)) {
    const std::vector<const Row*> good = good_rows(rows, scene);
    std::vector<const Row*> bad;
    for (const Row& row : rows)
      if (row.id.scene == scene && !row.ok()) bad.push_back(&row);
    if (!good.empty()) {
      text += fmt::format("\n## {}: by frame time\n\n", scene);
      if (std::none_of(good.begin(), good.end(), [](const Row* r) { return r->score.truth_error().has_value(); }))
        text += "The truth is black: relative errors are undefined, and no row is marked.\n\n";
      text += table_of(good);
    }
    if (!bad.empty()) text += fmt::format("\n## {}: not measured\n\n", scene) + reasons(bad);
  }
  return text;
}

}  // namespace penumbra
