// One line a row, everything flat: errors.truth.rel_rmse, parameters.rays, samples.frame_ms.0.
#include <map>

#include "harness/report/formats/exported_rows.h"
#include "harness/results/row_json.h"

namespace penumbra {
namespace {

using nlohmann::json;

/// [{"name": "map", "ms": 1}, ...] as {"map": {"ms": 1}, ...}.
json by_name(const json& list) {
  json out = json::object();
  for (json entry : list) {
    const std::string name = entry.at("name");
    entry.erase("name");
    out[name] = std::move(entry);
  }
  return out;
}

std::string cell_of(const json& value) {
  if (value.is_null()) return "";
  return value.is_string() ? value.get<std::string>() : value.dump();
}

void flatten(const json& value, const std::string& name, std::map<std::string, std::string>& cells) {
  if (!value.is_structured()) {
    cells[name] = cell_of(value);
    return;
  }
  for (const auto& [key, inner] : value.items()) {
    std::string path = name;
    if (!path.empty()) path += '.';
    flatten(inner, path += key, cells);
  }
}

std::map<std::string, std::string> cells_of(const Row& row) {
  json fields = to_json(row);
  fields.erase("defaults");
  for (const char* list : {"stages", "steps"})
    if (fields.contains(list)) fields[list] = by_name(fields[list]);
  std::map<std::string, std::string> cells;
  flatten(fields, "", cells);
  return cells;
}

/// What a reader looks for first; the others follow in alphabetical order.
const std::vector<std::string> first_columns = {"name",     "status",    "scene",    "technique",  "backend", "threads",
                                                "frame_ms", "update_ms", "shade_ms", "prepare_ms", "bytes"};

}  // namespace

Exported export_csv(const std::vector<Results>& runs) {
  std::vector<std::map<std::string, std::string>> lines;
  std::map<std::string, std::string> others;
  for (const Row& row : runs.front().rows) {
    lines.push_back(cells_of(row));
    others.insert(lines.back().begin(), lines.back().end());
  }
  std::vector<std::string> columns = first_columns;
  for (const std::string& column : first_columns) others.erase(column);
  for (const auto& [column, cell] : others) columns.push_back(column);
  std::string text = csv_line(columns);
  for (const auto& line : lines) {
    std::vector<std::string> cells;
    for (const std::string& column : columns) {
      const auto at = line.find(column);
      cells.push_back(at == line.end() ? "" : at->second);
    }
    text += csv_line(cells);
  }
  return {text, ""};
}

}  // namespace penumbra
