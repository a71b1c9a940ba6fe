// The Markdown tables of a run.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "harness/measure/timing.h"
#include "harness/results/row.h"

namespace penumbra {

std::vector<bool> pareto_optimal(const std::vector<const Row*>& rows) {
  std::vector<bool> optimal(rows.size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const Row& a = *rows[i];
    optimal[i] = a.ok() && a.truth_error() && std::none_of(rows.begin(), rows.end(), [&](const Row* b) {
                   if (b == &a || !b->ok() || !b->truth_error()) return false;
                   // Below the noise nobody can tell two errors apart.
                   const double noise = a.errors.at("truth").rel_noise.value_or(0.0);
                   const double ea = std::max(*a.truth_error(), noise), eb = std::max(*b->truth_error(), noise);
                   const double ta = a.median_frame_ms(), tb = b->median_frame_ms();
                   return tb <= ta && eb <= ea && (tb < ta || eb < ea);
                 });
  }
  return optimal;
}

std::string telling_parameters(const Row& row, const std::vector<const Row*>& rows) {
  std::string text;
  for (const auto& [name, value] : row.parameters.all()) {
    const bool telling = std::any_of(rows.begin(), rows.end(), [&, &key = name, &own = value](const Row* other) {
      if (other->technique != row.technique) return false;
      const auto at = other->parameters.all().find(key);
      return at != other->parameters.all().end() && at->second != own;
    });
    if (telling) text += (text.empty() ? "" : " ") + name + "=" + to_string(value);
  }
  return text;
}

std::string percent_text(const std::optional<double>& relative) {
  return relative ? fmt::format("{:.3g}", 100.0 * *relative) : "undefined";
}

std::string rung_text(const Row& row, const std::string& rung) {
  const auto at = row.errors.find(rung);
  return at == row.errors.end() ? "" : percent_text(at->second.report.all.rel_rmse);
}

std::string geometry_text(const Row& row) {
  return row.errors.contains("cube") && row.errors.contains("spheres") ? percent_text(row.geometry) : "";
}

namespace {

/// Like rung_text(), but an error that is noise is a tie, and an undefined one still has its size.
std::string rung_or_tie(const Row& row, const char* rung) {
  const auto at = row.errors.find(rung);
  if (at == row.errors.end()) return "";
  const Errors& e = at->second.report.all;
  const double noise = at->second.rel_noise.value_or(0.0);
  if (e.rel_rmse && *e.rel_rmse < noise) return fmt::format("< {:.2g} (tie)", 100.0 * noise);
  if (!e.rel_rmse && e.receivers > 0) return fmt::format("undefined (RMSE {:.3g})", e.rmse);
  return percent_text(e.rel_rmse);
}

std::string optional_number(const std::optional<double>& value) {
  return value ? fmt::format("{:.4f}", *value) : "";
}

/// Columns `signed`, `negative`, `PSNR`, `SSIM` and `FLIP`.
std::string truth_columns(const Row& row) {
  const auto at = row.errors.find("truth");
  if (at == row.errors.end()) return "| | | | |";
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
    const std::string backend = r.instruction_set.empty() ? r.backend : r.backend + " " + r.instruction_set;
    const std::string spheres = std::to_string(r.spheres) + (r.objective.empty() ? "" : " " + r.objective);
    text += fmt::format(
        "| {} | {} | {} | {} | {} | {} | {:.1f} | {:.3f} | {:.3f} | **{:.3f}** | {:.1f} | {} | {} | {} | {} | {} | "
        "{}\n",
        optimal[i] ? "P" : "", r.technique, backend, telling_parameters(r, scene_rows), r.threads, spheres,
        r.prepare_ms, median(r.update_ms), median(r.shade_ms), r.median_frame_ms(), double(r.bytes.total()) / 1048576.0,
        rung_or_tie(r, "truth"), rung_or_tie(r, "cube"), rung_or_tie(r, "spheres"), geometry_text(r),
        rung_or_tie(r, "13x13"), truth_columns(r));
  }
}

/// Orders rows of one scene as their relative errors do, where these are undefined too.
double truth_rmse(const Row& row) {
  const auto at = row.errors.find("truth");
  return at == row.errors.end() ? std::numeric_limits<double>::infinity() : at->second.report.all.rmse;
}

}  // namespace

std::string make_table(const std::vector<Row>& rows) {
  std::vector<std::string> scenes;
  for (const Row& row : rows)
    if (std::find(scenes.begin(), scenes.end(), row.scene) == scenes.end()) scenes.push_back(row.scene);
  std::string text =
      "Errors are relative RMSE in percent against each rung of the reference ladder; `(tie)`: below the reference's "
      "own "
      "noise. `P`: no other row of the scene is both faster and nearer to the truth.\n`signed`: mean of image - truth "
      "in "
      "W m^-2 sr^-1 (positive leaks light, negative over-darkens); `negative`: channel values below 0, left as they "
      "are. PSNR, SSIM and FLIP are against truth. `geometry`: rung spheres against rung cube, what the sphere set "
      "alone "
      "adds.\n";
  for (const std::string& scene : scenes) {
    std::vector<const Row*> good, bad;
    for (const Row& row : rows)
      if (row.scene == scene) (row.ok() ? good : bad).push_back(&row);
    const auto by = [&](auto key) {
      std::vector<const Row*> sorted = good;
      std::stable_sort(sorted.begin(), sorted.end(), [&](const Row* a, const Row* b) { return key(*a) < key(*b); });
      return sorted;
    };
    if (!good.empty()) {
      text += fmt::format("\n## {}: by frame time\n\n", scene);
      if (std::none_of(good.begin(), good.end(), [](const Row* r) { return r->truth_error().has_value(); }))
        text += "The truth is black: relative errors are undefined, and no row is marked.\n\n";
      append_rows(by([](const Row& r) { return r.median_frame_ms(); }), good, text);
      text += fmt::format("\n## {}: by error against truth\n\n", scene);
      append_rows(by(truth_rmse), good, text);
    }
    if (!bad.empty()) text += fmt::format("\n## {}: not measured\n\n", scene);
    for (const Row* row : bad) text += fmt::format("- {}: {}\n", row->name(), row->status);
  }
  return text;
}

}  // namespace penumbra
