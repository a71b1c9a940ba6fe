// A CSV that Apache Otava (formerly Hunter) searches for change points: a line a run, a column a figure. Otava reads no
// empty cells, so a figure is left out that one of the runs does not have.
#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>

#include "harness/report/formats/exported_rows.h"
#include "scenes/error.h"

namespace penumbra {
namespace {

using Figures = std::map<std::string, double>;

Figures figures_of(const Results& run) {
  Figures figures;
  for (const Row* row : measured_rows(run.rows)) {
    if (row->timing.timed()) figures[row->id.name() + " ms"] = row->timing.median_frame_ms();
    if (const auto error = row->score.truth_error()) figures[row->id.name() + " error"] = *error;
    if (!row->id.external()) figures[row->id.name() + " bytes"] = double(row->facts.bytes.total());
  }
  return figures;
}

/// Names of figures that all runs have, and how many another has.
std::pair<std::set<std::string>, std::size_t> shared_figures(const std::vector<Figures>& runs) {
  std::map<std::string, std::size_t> seen;
  for (const Figures& figures : runs)
    for (const auto& [name, value] : figures) ++seen[name];
  std::set<std::string> shared;
  for (const auto& [name, times] : seen)
    if (times == runs.size()) shared.insert(name);
  return {shared, seen.size() - shared.size()};
}

std::string date_of(const Results& run) {
  std::string date = context_text(run.context, "date");
  if (date.empty()) throw Error("its context has no date, which Otava's time column needs; measure it again");
  return date;
}

}  // namespace

Exported export_otava(const std::vector<Results>& runs) {
  std::vector<const Results*> sorted;
  sorted.reserve(runs.size());
  for (const Results& run : runs) sorted.push_back(&run);
  std::stable_sort(sorted.begin(), sorted.end(),
                   [](const Results* a, const Results* b) { return date_of(*a) < date_of(*b); });
  std::vector<Figures> figures;
  figures.reserve(runs.size());
  for (const Results* run : sorted) figures.push_back(figures_of(*run));
  const auto [shared, missing] = shared_figures(figures);
  std::vector<std::string> cells = {"time", "commit"};
  cells.insert(cells.end(), shared.begin(), shared.end());
  std::string text = csv_line(cells);
  for (std::size_t k = 0; k < sorted.size(); ++k) {
    cells = {date_of(*sorted[k]), context_text(sorted[k]->context, "commit")};
    for (const std::string& name : shared) cells.push_back(fmt::format("{}", figures[k].at(name)));
    text += csv_line(cells);
  }
  return {text, missing == 0 ? "" : fmt::format("{} figures are not in every run", missing)};
}

}  // namespace penumbra
