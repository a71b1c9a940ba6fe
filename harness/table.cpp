// The Markdown tables of a run.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "harness/results.h"
#include "harness/timing.h"

namespace penumbra {

std::vector<bool> pareto_optimal(const std::vector<const Row*>& rows) {
  std::vector<bool> optimal(rows.size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const Row& a = *rows[i];
    optimal[i] = a.ok() && std::none_of(rows.begin(), rows.end(), [&](const Row* b) {
                   if (b == &a || !b->ok()) return false;
                   const auto at = a.errors.find("truth");
                   const double noise = at == a.errors.end() ? 0.0 : at->second.rel_noise;
                   // Below the noise nobody can tell two errors apart.
                   const double ea = std::max(a.truth_error(), noise), eb = std::max(b->truth_error(), noise);
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

namespace {

std::string percent(const Row& row, const char* rung) {
  const auto at = row.errors.find(rung);
  if (at == row.errors.end()) return "";
  const double error = 100.0 * at->second.report.all.rel_rmse, noise = 100.0 * at->second.rel_noise;
  return error < noise ? fmt::format("< {:.2g} (tie)", noise) : fmt::format("{:.3g}", error);
}

std::string optional_number(const std::optional<double>& value) {
  return value ? fmt::format("{:.4f}", *value) : "";
}

void append_rows(const std::vector<const Row*>& rows, const std::vector<const Row*>& scene_rows, std::string& text) {
  text +=
      "| | technique | backend | parameters | threads | spheres | prepare ms | update ms | shade ms | frame ms | "
      "MiB | truth % | cube % | spheres % | geometry % | 13x13 % | signed | negative | PSNR | SSIM | FLIP |\n"
      "|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|\n";
  const std::vector<bool> optimal = pareto_optimal(rows);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const Row& r = *rows[i];
    const auto at = r.errors.find("truth");
    const Errors all = at == r.errors.end() ? Errors{} : at->second.report.all;
    const std::string backend = r.instruction_set.empty() ? r.backend : r.backend + " " + r.instruction_set;
    const std::string spheres = std::to_string(r.spheres) + (r.objective.empty() ? "" : " " + r.objective);
    const std::string geometry = r.geometry < 0.0 ? "" : fmt::format("{:.3g}", 100.0 * r.geometry);
    text += fmt::format(
        "| {} | {} | {} | {} | {} | {} | {:.1f} | {:.3f} | {:.3f} | **{:.3f}** | {:.1f} | {} | {} | {} | {} | {} | "
        "{:+.2g} "
        "| {} | {:.1f} | {} | {} |\n",
        optimal[i] ? "P" : "", r.technique, backend, telling_parameters(r, scene_rows), r.threads, spheres,
        r.prepare_ms, median(r.update_ms), median(r.shade_ms), r.median_frame_ms(), double(r.bytes.total()) / 1048576.0,
        percent(r, "truth"), percent(r, "cube"), percent(r, "spheres"), geometry, percent(r, "13x13"), all.mean_signed,
        all.negative, all.psnr, optional_number(all.ssim), optional_number(all.flip));
  }
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
      append_rows(by([](const Row& r) { return r.median_frame_ms(); }), good, text);
      text += fmt::format("\n## {}: by error against truth\n\n", scene);
      append_rows(by([](const Row& r) { return r.truth_error(); }), good, text);
    }
    if (!bad.empty()) text += fmt::format("\n## {}: not measured\n\n", scene);
    for (const Row* row : bad) text += fmt::format("- {}: {}\n", row->name(), row->status);
  }
  return text;
}

}  // namespace penumbra
