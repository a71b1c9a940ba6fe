// Tables of where the time goes, and of what to choose.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "harness/results/row.h"

namespace penumbra {
namespace {

/// Distinct values in order of first appearance.
template <class Values>
void add_distinct(const Values& values, std::vector<std::string>& all) {
  for (const std::string& value : values)
    if (std::find(all.begin(), all.end(), value) == all.end()) all.push_back(value);
}

std::vector<const Row*> good_rows(const std::vector<Row>& rows, const std::string& scene) {
  std::vector<const Row*> good;
  for (const Row& row : rows)
    if (row.ok() && row.scene == scene) good.push_back(&row);
  return good;
}

/// Technique, backend, telling parameters and threads, in columns.
std::string columns(const Row& row, const std::vector<const Row*>& rows) {
  return fmt::format("{} | {} | {} | {}", row.technique, row.backend, telling_parameters(row, rows), row.threads);
}

std::vector<std::string> scenes_of(const std::vector<Row>& rows) {
  std::vector<std::string> scenes;
  for (const Row& row : rows) add_distinct(std::vector{row.scene}, scenes);
  return scenes;
}

}  // namespace

std::string make_stages_table(const std::vector<Row>& rows) {
  std::string text;
  for (const std::string& scene : scenes_of(rows)) {
    const std::vector<const Row*> good = good_rows(rows, scene);
    std::vector<std::string> names;
    for (const Row* row : good)
      for (const StageSamples& stage : row->stages) add_distinct(std::vector{stage.name}, names);
    if (names.empty()) continue;
    text += fmt::format(
        "\n## {}: stages\n\nMedian ms of the named parts of update and shade; `view`: camera rays, not part of the "
        "frame.\n\n| technique | backend | parameters | threads | view | frame |",
        scene);
    std::string rule = "|---|---|---|---|---|---|";
    for (const std::string& name : names) text += " " + name + " |", rule += "---|";
    text += "\n" + rule + "\n";
    for (const Row* row : good) {
      if (row->stages.empty()) continue;
      text += fmt::format("| {} | {} | {:.2f} |", columns(*row, good),
                          row->view_ms < 0 ? "" : fmt::format("{:.2f}", row->view_ms), row->median_frame_ms());
      for (const std::string& name : names) {
        const double ms = row->stages_ms({name});
        text += std::isnan(ms) ? " |" : fmt::format(" {:.2f} |", ms);
      }
      text += "\n";
    }
  }
  return text;
}

std::string make_baseline_table(const std::string& baseline, const std::vector<Row>& rows) {
  std::string text;
  for (const std::string& scene : scenes_of(rows)) {
    const std::vector<const Row*> good = good_rows(rows, scene);
    std::string lines;
    for (const Row* row : good) {
      const auto at = row->errors.find(baseline);
      if (at == row->errors.end()) continue;
      const Errors& e = at->second.report.all;
      const auto optional = [](const std::optional<double>& v) { return v ? fmt::format("{:.4f}", *v) : ""; };
      lines += fmt::format("| {} | {} | {} | {} |\n", columns(*row, good), percent_text(e.rel_rmse), optional(e.ssim),
                           optional(e.flip));
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

namespace {

/// The cheapest row of a technique whose error against truth is defined and within the limit.
const Row* cheapest_within(double limit, const std::string& technique, const std::vector<const Row*>& rows) {
  const Row* best = nullptr;
  for (const Row* row : rows)
    if (row->technique == technique && row->truth_error() && *row->truth_error() <= limit &&
        (!best || row->median_frame_ms() < best->median_frame_ms()))
      best = row;
  return best;
}

}  // namespace

std::string make_choice_table(const std::vector<Row>& rows) {
  constexpr double limits[] = {0.01, 0.03, 0.1};
  std::string text;
  for (const std::string& scene : scenes_of(rows)) {
    const std::vector<const Row*> good = good_rows(rows, scene);
    std::vector<std::string> techniques;
    for (const Row* row : good) add_distinct(std::vector{row->technique}, techniques);
    if (techniques.size() < 2) continue;
    text += fmt::format("\n## {}: the cheapest row of each technique within an error\n\n", scene);
    if (std::none_of(good.begin(), good.end(), [](const Row* row) { return row->truth_error().has_value(); })) {
      text += "None: the truth is black, and relative errors are undefined.\n";
      continue;
    }
    text += "| technique |";
    for (const double limit : limits) text += fmt::format(" {:g} % |", 100.0 * limit);
    text += "\n|---|---|---|---|\n";
    for (const std::string& technique : techniques) {
      text += "| " + technique + " |";
      for (const double limit : limits) {
        const Row* best = cheapest_within(limit, technique, good);
        text += best ? fmt::format(" {:.2f} ms, {:.2f} %, {} {} |", best->median_frame_ms(),
                                   100.0 * *best->truth_error(), best->backend, telling_parameters(*best, good))
                     : " |";
      }
      text += "\n";
    }
  }
  return text;
}

}  // namespace penumbra
