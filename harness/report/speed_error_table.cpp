#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "harness/report/row_text.h"
#include "harness/report/tables.h"
#include "harness/results/derived.h"
#include "harness/results/statistics.h"

namespace penumbra {

namespace {

std::string optional_number(const std::optional<double>& value) {
  return value ? fmt::format("{:.4f}", *value) : "";
}

/// Columns `signed`, `negative`, `PSNR`, `SSIM` and `FLIP`.
std::string truth_columns(const Row& row) {
  const auto at = row.score.errors.find("truth");
  if (at == row.score.errors.end()) return "| | | | |";
  const Errors& e = at->second.report.all;
  return fmt::format("{} | {} | {} | {} | {} |", e.receivers > 0 ? fmt::format("{:+.2g}", e.mean_signed) : "undefined",
                     e.negative, e.psnr ? fmt::format("{:.1f}", *e.psnr) : "undefined", optional_number(e.ssim),
                     optional_number(e.flip));
}

void append_rows(const std::vector<const Row*>& rows, const std::vector<const Row*>& scene_rows, std::string& text) {
  text +=
      "| | technique | backend | parameters | threads | spheres | prepare ms | update ms | shade ms | frame ms | "
      "MiB | truth % | cube % | spheres % | geometry % | 13x13 % | signed | negative | PSNR | SSIM | FLIP |\n"
      "|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|\n";
  const std::vector<bool> optimal = pareto_optimal(rows);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const Row& r = *rows[i];
    const std::string backend =
        r.facts.instruction_set.empty() ? r.id.backend : r.id.backend + " " + r.facts.instruction_set;
    text += fmt::format(
        "| {} | {} | {} | {} | {} | {} | {} | {} | {} | {} | {} | {} | {} | {} | {} | {} | "
        "{}\n",
        optimal[i] ? "P" : "", r.id.technique, backend, telling_parameters(r, scene_rows), threads_text(r.id),
        spheres_text(r.id), prepare_text(r.timing), median_text(r.timing.update_ms), median_text(r.timing.shade_ms),
        milliseconds_text(r.timing), mebibytes_text(r), rung_or_tie(r, "truth"), rung_or_tie(r, "cube"),
        rung_or_tie(r, "spheres"), geometry_text(r), rung_or_tie(r, "13x13"), truth_columns(r));
  }
}

/// Rows without a time come last.
double frame_ms(const Row& row) {
  return row.timing.timed() ? row.timing.median_frame_ms() : std::numeric_limits<double>::infinity();
}

/// Orders rows of one scene as their relative errors do, where these are undefined too.
double truth_rmse(const Row& row) {
  const auto at = row.score.errors.find("truth");
  return at == row.score.errors.end() ? std::numeric_limits<double>::infinity() : at->second.report.all.rmse;
}

}  // namespace

std::string make_table(const std::vector<Row>& rows) {
  std::string text =
      "Errors are relative RMSE in percent against each rung of the reference ladder; `(tie)`: no more than the "
      "reference's own noise makes of an exact image. Frame times are medians with half the interquartile range of the "
      "repetitions; where these ranges overlap, times are ties. `P`: no other row of the scene is faster and not "
      "farther from the truth, or nearer and not slower.\n`signed`: mean of image - truth "
      "in "
      "W m^-2 sr^-1 (positive leaks light, negative over-darkens); `negative`: channel values below 0, left as they "
      "are. PSNR, SSIM and FLIP are against truth. `geometry`: rung spheres against rung cube, what the sphere set "
      "alone "
      "adds.\n";
  for (const std::string& scene : scenes_of(rows)) {
    std::vector<const Row*> good, bad;
    for (const Row& row : rows)
      if (row.id.scene == scene) (row.ok() ? good : bad).push_back(&row);
    const auto by = [&](auto key) {
      std::vector<const Row*> sorted = good;
      std::stable_sort(sorted.begin(), sorted.end(), [&](const Row* a, const Row* b) { return key(*a) < key(*b); });
      return sorted;
    };
    if (!good.empty()) {
      text += fmt::format("\n## {}: by frame time\n\n", scene);
      if (std::none_of(good.begin(), good.end(), [](const Row* r) { return r->score.truth_error().has_value(); }))
        text += "The truth is black: relative errors are undefined, and no row is marked.\n\n";
      append_rows(by(frame_ms), good, text);
      text += fmt::format("\n## {}: by error against truth\n\n", scene);
      append_rows(by(truth_rmse), good, text);
    }
    if (!bad.empty()) text += fmt::format("\n## {}: not measured\n\n", scene);
    for (const Row* row : bad) text += fmt::format("- {}: {}\n", row->id.name(), row->status);
  }
  return text;
}

}  // namespace penumbra
