#include "harness/report/published_times.h"

#include <fmt/ranges.h>

#include <cmath>
#include <map>
#include <tuple>

#include "harness/report/markdown_table.h"
#include "harness/report/published.h"
#include "harness/report/row_text.h"
#include "harness/results/text.h"
#include "scenes/error.h"
#include "scenes/pattern.h"

namespace penumbra {
namespace {

using Key = std::tuple<std::string, std::string, std::string>;  // table, subject, variant

struct PublishedValues {
  std::string title;
  std::map<Key, double> ms;
};

PublishedValues load_values(const std::string& name) {
  const CsvFile file = load_published_csv(name);
  if (file.columns != std::vector<std::string>{"table", "subject", "variant", "value", "unit"})
    throw Error("{}: columns must be table, subject, variant, value, unit", file.path);
  PublishedValues values{file.title, {}};
  for (const CsvFile::Line& line : file.lines)
    if (line.cells[4] == "ms") values.ms[{line.cells[0], line.cells[1], line.cells[2]}] = file.number(line, 3);
  return values;
}

double published_ms(const PublishedValues& values, const PublishedTime& line, const PublishedTimes& asked) {
  const auto at = values.ms.find({line.table, line.subject, line.variant});
  if (at == values.ms.end())
    throw Error("suite '{}': results/published/{}.csv has no time for table {}, {}, {}", asked.suite, asked.file,
                line.table, line.subject, line.variant);
  return at->second;
}

Pattern pattern_of(const PublishedTime& line, const PublishedTimes& asked) {
  return {fmt::format("suite '{}': row", asked.suite), line.row};
}

double measured_ms(const Row& row, const PublishedTime& line) {
  return line.stages.empty() ? row.timing.median_frame_ms() : row.timing.stages_ms(line.stages);
}

}  // namespace

void check_published_times(const PublishedTimes& asked) {
  const PublishedValues values = load_values(asked.file);
  for (const PublishedTime& line : asked.times) {
    published_ms(values, line, asked);
    pattern_of(line, asked);
  }
}

std::string make_published_times_table(const PublishedTimes& asked, const std::vector<Row>& rows) {
  const PublishedValues values = load_values(asked.file);
  MarkdownTable table({"table", "subject", "variant", "published ms", "ratio", "row", "stages", "ms", "our ratio"});
  struct First {
    double published, measured;
  };
  std::map<Key, First> firsts;
  for (const PublishedTime& line : asked.times)
    for (const Row& row : rows) {
      if (!row.ok() || !row.timing.timed() || !is_in(pattern_of(line, asked), row.id)) continue;
      const double published = published_ms(values, line, asked), measured = measured_ms(row, line);
      const std::string group = fmt::format("{} {}, {} threads", row.id.scene, row.id.backend, row.id.threads);
      const First& first =
          firsts.try_emplace({line.table, line.subject, group}, First{published, measured}).first->second;
      table.add({line.table, line.subject, line.variant, fmt::format("{}", published),
                 three_digits(published / first.published), row.id.technique + ", " + group,
                 line.stages.empty() ? "frame" : fmt::format("{}", fmt::join(line.stages, " + ")),
                 three_digits(measured), "**" + three_digits(measured / first.measured) + "**"});
    }
  return fmt::format(
             "\n## Beside the published times\n\n{}\n\nRatios are over the first line of the same table, subject, "
             "backend and threads.\n\n",
             values.title) +
         table.text();
}

}  // namespace penumbra
