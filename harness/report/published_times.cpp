#include "harness/report/published_times.h"

#include <fmt/ranges.h>

#include <cmath>
#include <map>
#include <regex>
#include <tuple>

#include "harness/report/published.h"
#include "scenes/error.h"

namespace penumbra {
namespace {

using Key = std::tuple<std::string, std::string, std::string>;  // table, subject, variant

struct Values {
  std::string title;
  std::map<Key, double> ms;
};

Values load_values(const std::string& name) {
  const CsvFile file = load_published_csv(name);
  if (file.columns != std::vector<std::string>{"table", "subject", "variant", "value", "unit"})
    throw Error("{}: columns must be table, subject, variant, value, unit", file.path);
  Values values{file.title, {}};
  for (const CsvFile::Line& line : file.lines)
    if (line.cells[4] == "ms") values.ms[{line.cells[0], line.cells[1], line.cells[2]}] = file.number(line, 3);
  return values;
}

double published_ms(const Values& values, const PublishedTime& line, const Suite& suite) {
  const auto at = values.ms.find({line.table, line.subject, line.variant});
  if (at == values.ms.end())
    throw Error("suite '{}': results/published/{}.csv has no time for table {}, {}, {}", suite.name, suite.published,
                line.table, line.subject, line.variant);
  return at->second;
}

double measured_ms(const Row& row, const PublishedTime& line) {
  return line.stages.empty() ? row.timing.median_frame_ms() : row.timing.stages_ms(line.stages);
}

}  // namespace

void check_published_times(const Suite& suite) {
  const Values values = load_values(suite.published);
  for (const PublishedTime& line : suite.published_times) {
    published_ms(values, line, suite);
    try {
      std::regex checked(line.row);
    } catch (const std::regex_error& e) {
      throw Error("suite '{}': row '{}' is not a regular expression: {}", suite.name, line.row, e.what());
    }
  }
}

std::string make_published_times_table(const Suite& suite, const std::vector<Row>& rows) {
  const Values values = load_values(suite.published);
  std::string text = fmt::format(
      "\n## Beside the published times\n\n{}\n\nRatios are over the first line of the same table, subject, backend and "
      "threads.\n\n| table | subject | variant | published ms | ratio | row | stages | ms | ratio |\n"
      "|---|---|---|---|---|---|---|---|---|\n",
      values.title);
  struct First {
    double published, measured;
  };
  std::map<Key, First> firsts;
  for (const PublishedTime& line : suite.published_times)
    for (const Row& row : rows) {
      if (!row.ok() || !row.timing.timed() || !std::regex_search(row.id.name(), std::regex(line.row))) continue;
      const double published = published_ms(values, line, suite), measured = measured_ms(row, line);
      const std::string group = fmt::format("{} {}, {} threads", row.id.scene, row.id.backend, row.id.threads);
      const First& first =
          firsts.try_emplace({line.table, line.subject, group}, First{published, measured}).first->second;
      text += fmt::format("| {} | {} | {} | {} | {:.3f} | {}, {} | {} | {:.3f} | **{:.3f}** |\n", line.table,
                          line.subject, line.variant, published, published / first.published, row.id.technique, group,
                          line.stages.empty() ? "frame" : fmt::format("{}", fmt::join(line.stages, " + ")), measured,
                          measured / first.measured);
    }
  return text;
}

}  // namespace penumbra
