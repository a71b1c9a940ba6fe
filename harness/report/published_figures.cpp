#include "harness/report/published_figures.h"

#include <cmath>

#include "harness/report/published.h"
#include "harness/report/published_times.h"
#include "scenes/error.h"
#include "scenes/log.h"
#include "scenes/names.h"

namespace penumbra {
namespace {

using nlohmann::json;

json number_or_null(double value) {
  return std::isfinite(value) ? json(value) : json();
}

json line_json(const PublishedFigure& figure) {
  json out = {{"keys", figure.keys},
              {"device", figure.device},
              {"unit", figure.unit},
              {"published", figure.published},
              {"row", figure.row ? json(figure.row->id.name()) : json()},
              {"here", number_or_null(figure.here)},
              {"ratio", number_or_null(figure.here / figure.published)}};
  if (std::isfinite(figure.here_relative)) {
    out["published_relative"] = figure.published_relative;
    out["here_relative"] = figure.here_relative;
  }
  if (!figure.stages.empty()) out["stages"] = figure.stages;
  return out;
}

json table_json(const CsvFile& file, const std::string& name, const std::vector<PublishedFigure>& figures) {
  std::vector<std::string> columns = file.columns;  // without the value, and its unit
  std::erase_if(columns, [](const std::string& c) { return c == "fps" || c == "value" || c == "unit"; });
  json out = {{"title", file.title},
              {"notes", file.notes},
              {"source", "results/published/" + name + ".csv"},
              {"columns", columns},
              {"lines", json::array()}};
  for (const PublishedFigure& figure : figures) out["lines"].push_back(line_json(figure));
  return out;
}

/// Figures of a table of times if the context asks for any, else of one of frame rates.
std::vector<PublishedFigure> figures_beside(const Results& results, const std::string& name) {
  const auto times = results.context.find("published_times");
  if (times == results.context.end()) return PublishedTable::load(name).beside(results.rows);
  return published_times_beside({results.context.value("suite", ""), name, published_times_from(*times)}, results.rows);
}

}  // namespace

json make_published_figures(const Results& results) {
  json all = json::array();
  const auto name = results.context.find("published");
  if (name == results.context.end() || !name->is_string()) return all;
  try {
    if (const std::string fault = name_fault(*name); !fault.empty()) throw Error("published: {}", fault);
    all.push_back(table_json(load_published_csv(*name), *name, figures_beside(results, *name)));
  } catch (const std::exception& e) {
    warn("no published figures beside these rows: {}", e.what());
  }
  return all;
}

}  // namespace penumbra
