#include "harness/report/published_times.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <map>
#include <set>
#include <tuple>

#include "harness/report/markdown_table.h"
#include "harness/report/row_text.h"
#include "harness/results/text.h"
#include "scenes/error.h"
#include "scenes/pattern.h"

namespace penumbra {
namespace {

using Key = std::tuple<std::string, std::string, std::string>;  // table, subject, variant

Key key_of(const PublishedFigure& figure) {
  return {figure.keys.at("table"), figure.keys.at("subject"), figure.keys.at("variant")};
}

/// Every figure of a file, alone.
std::vector<PublishedFigure> load_figures(const std::string& name) {
  const CsvFile file = load_published_csv(name);
  if (file.columns != std::vector<std::string>{"table", "subject", "variant", "value", "unit"})
    throw Error("{}: columns must be table, subject, variant, value, unit", file.path);
  std::vector<PublishedFigure> figures;
  figures.reserve(file.lines.size());
  for (const CsvFile::Line& line : file.lines)
    figures.push_back({{{"table", line.cells[0]}, {"subject", line.cells[1]}, {"variant", line.cells[2]}},
                       "",
                       line.cells[4],
                       file.number(line, 3),
                       nullptr});
  return figures;
}

/// The one that a suite asks for.
const PublishedFigure& figure_of(const PublishedTime& line, const PublishedTimes& asked,
                                 const std::vector<PublishedFigure>& figures) {
  const auto at = std::find_if(figures.begin(), figures.end(), [&](const PublishedFigure& figure) {
    return figure.unit == "ms" && key_of(figure) == Key(line.table, line.subject, line.variant);
  });
  if (at == figures.end())
    throw Error("suite '{}': results/published/{}.csv has no time for table {}, {}, {}", asked.suite, asked.file,
                line.table, line.subject, line.variant);
  return *at;
}

Pattern pattern_of(const PublishedTime& line, const PublishedTimes& asked) {
  return {fmt::format("suite '{}': row", asked.suite), line.row};
}

double measured_ms(const Row& row, const PublishedTime& line) {
  return line.stages.empty() ? row.timing.median_frame_ms() : row.timing.stages_ms(line.stages);
}

/// Rows that are compared with each other.
std::string group_of(const Row& row) {
  return fmt::format("{} {}, {} threads", row.id.scene, row.id.backend, row.id.threads);
}

}  // namespace

void check_published_times(const PublishedTimes& asked) {
  const std::vector<PublishedFigure> figures = load_figures(asked.file);
  for (const PublishedTime& line : asked.times) {
    figure_of(line, asked, figures);
    pattern_of(line, asked);
  }
}

std::vector<PublishedFigure> published_times_beside(const PublishedTimes& asked, const std::vector<Row>& rows) {
  const std::vector<PublishedFigure> all = load_figures(asked.file);
  std::vector<PublishedFigure> figures;
  std::map<Key, std::pair<double, double>> firsts;  // published and measured
  std::set<Key> told;
  for (const PublishedTime& line : asked.times) {
    const Pattern pattern = pattern_of(line, asked);
    PublishedFigure figure = figure_of(line, asked, all);
    figure.stages = line.stages;
    const std::size_t before = figures.size();
    for (const Row& row : rows) {
      if (!row.ok() || !row.timing.timed() || !is_in(pattern, row.id)) continue;
      figure.row = &row, figure.here = measured_ms(row, line);
      const auto& [published, measured] =
          firsts.try_emplace({line.table, line.subject, group_of(row)}, figure.published, figure.here).first->second;
      figure.published_relative = figure.published / published, figure.here_relative = figure.here / measured;
      figures.push_back(figure);
    }
    if (figures.size() == before) figures.push_back(figure);
    told.insert(key_of(figure));
  }
  for (const PublishedFigure& figure : all)
    if (!told.contains(key_of(figure))) figures.push_back(figure);
  return figures;
}

std::string make_published_times_table(const PublishedTimes& asked, const std::vector<Row>& rows) {
  MarkdownTable table({"table", "subject", "variant", "published ms", "ratio", "row", "stages", "ms", "our ratio"});
  for (const PublishedFigure& f : published_times_beside(asked, rows)) {
    if (!f.row) continue;
    table.add({f.keys.at("table"), f.keys.at("subject"), f.keys.at("variant"), fmt::format("{}", f.published),
               three_digits(f.published_relative), f.row->id.technique + ", " + group_of(*f.row),
               f.stages.empty() ? "frame" : fmt::format("{}", fmt::join(f.stages, " + ")), three_digits(f.here),
               "**" + three_digits(f.here_relative) + "**"});
  }
  return fmt::format(
             "\n## Beside the published times\n\n{}\n\nRatios are over the first line of the same table, subject, "
             "backend and threads.\n\n",
             load_published_csv(asked.file).title) +
         table.text();
}

}  // namespace penumbra
