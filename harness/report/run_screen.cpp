#include "harness/report/run_screen.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <map>

#include "harness/report/row_text.h"
#include "harness/report/screen.h"
#include "harness/results/derived.h"
#include "harness/results/text.h"

namespace penumbra {
namespace {

constexpr int most_lines = 25;
constexpr double limits[] = {0.01, 0.03, 0.1};

std::string spread_text(const Row& row) {
  return row.timing.frame_ms.size() < 2 ? "" : fmt::format("±{:.2g}", row.timing.frame_spread_ms());
}

/// "pixel-basis 64 spheres visibility=raster"; backend and threads have a column of their own.
std::string label(const Row& row, const std::vector<const Row*>& rows) {
  std::string text = row.id.technique;
  if (row.id.reads_spheres && row.id.spheres > 0) text += fmt::format(" {} spheres", row.id.spheres);
  const std::string parameters = telling_parameters(row, rows);
  return parameters.empty() ? text : text + " " + parameters;
}

/// One row in the columns of all sections.
std::vector<std::string> cells(const std::string& lead, const Row& row, const std::vector<const Row*>& rows) {
  return {lead,
          label(row, rows),
          row.id.backend + (row.id.threads > 1 ? fmt::format(" x{}", row.id.threads) : ""),
          three_digits(row.timing.median_frame_ms()),
          spread_text(row),
          truth_text(row)};
}

std::string scene_line(const std::string& scene, const std::vector<const Row*>& good) {
  if (good.empty()) return scene + ": nothing was measured";
  const auto truth = good.front()->score.errors.find("truth");
  const auto noise = truth == good.front()->score.errors.end() ? std::nullopt : truth->second.rel_noise;
  return fmt::format("{}: {} rows, {} receivers{}", scene, good.size(), with_thousands(good.front()->id.receivers),
                     noise ? fmt::format(", truth ±{} %", three_digits(100.0 * *noise)) : ", the truth is black");
}

/// "3 rows failed: why" by reason, the most frequent first; one line each, three at most.
std::vector<std::string> complaints(const std::vector<Row>& rows, int width) {
  std::map<std::string, int> counts;
  for (const Row& row : rows)
    if (!row.ok()) ++counts[row.status];
  std::vector<std::pair<int, std::string>> sorted;
  sorted.reserve(counts.size());
  for (const auto& [status, count] : counts) sorted.emplace_back(-count, status);
  std::sort(sorted.begin(), sorted.end());
  std::vector<std::string> lines;
  for (const auto& [count, status] : sorted) {
    if (lines.size() == 3) {
      lines.back() = "... and more reasons why rows were not measured, in table.md";
      break;
    }
    lines.push_back(cut_to_columns(fmt::format("{} row{} {}", -count, count == -1 ? "" : "s", status), width));
  }
  return lines;
}

class Screen {
 public:
  Screen(const RunSummary& summary, const std::vector<Row>& rows, int width)
      : summary_(summary), rows_(rows), width_(width) {}

  std::string text() {
    const std::vector<std::string> scenes = scenes_of(rows_), notes = complaints(rows_, width_);
    const int room = most_lines - 3 - int(notes.size());  // but for the first line, the columns' titles and the last
    const bool all_limits = int(scenes.size()) * 4 <= room;
    std::size_t shown = 0;
    for (; shown < scenes.size(); ++shown) {
      const int needed = all_limits ? 4 : 1;
      if (used_ + needed > room - (shown + 1 < scenes.size() ? 1 : 0)) break;
      all_limits ? add_scene(scenes[shown]) : add_scene_in_one_line(scenes[shown]);
    }
    if (shown < scenes.size()) table_.line(fmt::format("... and {} more scenes", scenes.size() - shown)), ++used_;
    if (scenes.size() == 1) add_undominated(scenes.front(), room - used_);
    std::string text = cut_to_columns(fmt::format("{}: {} rows on {} scene{}, {}", summary_.suite, rows_.size(),
                                                  scenes.size(), scenes.size() == 1 ? "" : "s", summary_.machine),
                                      width_) +
                       "\n" + table_.text();
    for (const std::string& note : notes) text += note + "\n";
    return text +
           cut_to_columns(
               fmt::format("All rows, errors and stages ({:.0f} s): {}/table.md", summary_.seconds, summary_.folder),
               width_) +
           "\n";
  }

 private:
  void add_scene(const std::string& scene) {
    const std::vector<const Row*> good = good_rows(rows_, scene);
    table_.line(cut_to_columns(scene_line(scene, good), width_ - 2));
    ++used_;
    for (const double limit : limits) add_best("", limit, good);
  }

  void add_scene_in_one_line(const std::string& scene) { add_best(scene + " ", 0.03, good_rows(rows_, scene)); }

  void add_best(const std::string& lead, double limit, const std::vector<const Row*>& good) {
    const std::string within = fmt::format("{}within {:g} %", lead, 100.0 * limit);
    if (const Row* best = best_within(limit, good)) table_.row(cells(within, *best, good));
    else table_.row({within, "none", "", "", "", ""});
    ++used_;
  }

  /// Rows that no other row beats, fastest first.
  void add_undominated(const std::string& scene, int room) {
    const std::vector<const Row*> good = good_rows(rows_, scene);
    const std::vector<bool> optimal = pareto_optimal(good);
    std::vector<const Row*> best;
    for (std::size_t i = 0; i < good.size(); ++i)
      if (optimal[i] && !good[i]->timing.frame_ms.empty()) best.push_back(good[i]);
    std::stable_sort(best.begin(), best.end(), [](const Row* a, const Row* b) {
      return a->timing.median_frame_ms() < b->timing.median_frame_ms();
    });
    if (best.empty() || room < 2) return;
    table_.line("beaten by no other row:");
    for (std::size_t i = 0; i < std::min(best.size(), std::size_t(room - 1)); ++i)
      table_.row(cells("", *best[i], good));
  }

  const RunSummary& summary_;
  const std::vector<Row>& rows_;
  const int width_;
  TextTable table_{{{"", width_ - 54, Align::left},
                    {"technique", width_ - 46, Align::left},
                    {"backend", 10, Align::left},
                    {"ms", 6, Align::right},
                    {"", 9, Align::left},
                    {"error %", 9, Align::right}},
                   width_};
  int used_ = 0;
};

}  // namespace

std::string make_run_screen(const RunSummary& summary, const std::vector<Row>& rows, int width) {
  return Screen(summary, rows, width).text();
}

}  // namespace penumbra
