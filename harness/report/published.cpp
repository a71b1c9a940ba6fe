#include "harness/report/published.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "harness/report/markdown_table.h"
#include "harness/report/row_text.h"
#include "harness/results/text.h"
#include "scenes/assets.h"
#include "scenes/error.h"

namespace penumbra {
namespace {

std::vector<std::string> cells_of(const std::string& line) {
  std::vector<std::string> cells;
  std::istringstream in(line);
  for (std::string cell; std::getline(in, cell, ',');) cells.push_back(cell);
  return cells;
}

}  // namespace

CsvFile load_published_csv(const std::string& name) {
  CsvFile file;
  file.path = data_folder() + "/../results/published/" + name + ".csv";
  std::ifstream in(file.path);
  if (!in) throw Error("published table '{}' is missing: no {}", name, file.path);
  int number = 0;
  for (std::string line; std::getline(in, line);) {
    ++number;
    if (line.starts_with("#")) {
      const std::string comment = line.substr(std::min(line.size(), std::size_t(2)));
      if (file.title.empty()) file.title = comment;
      else file.notes.push_back(comment);
      continue;
    }
    const std::vector<std::string> cells = cells_of(line);
    if (file.columns.empty()) {
      file.columns = cells;
      continue;
    }
    if (cells.size() != file.columns.size())
      throw Error("{}:{}: {} columns expected", file.path, number, file.columns.size());
    file.lines.push_back({number, cells});
  }
  return file;
}

double CsvFile::number(const Line& line, std::size_t column) const {
  try {
    return std::stod(line.cells[column]);
  } catch (const std::exception&) {
    throw Error("{}:{}: '{}' is not a number", path, line.number, line.cells[column]);
  }
}

PublishedTable PublishedTable::load(const std::string& name) {
  const CsvFile file = load_published_csv(name);
  if (file.columns.size() < 3 || file.columns.back() != "fps")
    throw Error("{}: the last column must be fps", file.path);
  PublishedTable table;
  table.title_ = file.title;
  table.keys_.assign(file.columns.begin(), file.columns.end() - 2);
  for (const CsvFile::Line& line : file.lines) {
    Line entry;
    for (std::size_t k = 0; k + 2 < line.cells.size(); ++k) entry.keys[file.columns[k]] = line.cells[k];
    entry.device = line.cells[line.cells.size() - 2];
    entry.fps = file.number(line, line.cells.size() - 1);
    if (std::find(table.devices_.begin(), table.devices_.end(), entry.device) == table.devices_.end())
      table.devices_.push_back(entry.device);
    table.lines_.push_back(std::move(entry));
  }
  return table;
}

namespace {

/// A row's value of a key column: "spheres", or a parameter; empty if it has none of that name.
std::string value_of(const RowIdentity& id, const std::string& key) {
  if (key == "spheres") return spheres_text(id).empty() ? "" : std::to_string(id.spheres);
  const auto at = id.parameters.find(key);
  return at == id.parameters.end() ? "" : to_string(at->second);
}

}  // namespace

bool PublishedTable::Line::is_like(const Row& row) const {
  return std::all_of(keys.begin(), keys.end(),
                     [&](const auto& key) { return key.second.empty() || value_of(row.id, key.first) == key.second; });
}

std::map<std::string, double> PublishedTable::lookup(const Row& row) const {
  std::map<std::string, double> found;
  for (const Line& line : lines_)
    if (line.is_like(row)) found[line.device] = line.fps;
  return found;
}

std::vector<PublishedFigure> PublishedTable::beside(const std::vector<Row>& rows) const {
  std::vector<PublishedFigure> figures;
  figures.reserve(lines_.size());
  for (const Line& line : lines_) {
    PublishedFigure figure{line.keys, line.device, "fps", line.fps, nullptr};
    const std::size_t before = figures.size();
    for (const Row& row : rows) {
      if (!row.ok() || !row.timing.timed() || !line.is_like(row)) continue;
      figure.row = &row, figure.here = 1e3 / row.timing.median_frame_ms();
      figures.push_back(figure);
    }
    if (figures.size() == before) figures.push_back(figure);
  }
  return figures;
}

std::string make_published_table(const PublishedTable& table, const std::vector<Row>& rows) {
  std::vector<std::string> columns = {"scene", "technique", "backend", "threads"};
  columns.insert(columns.end(), table.keys().begin(), table.keys().end());
  columns.push_back("fps");
  for (const std::string& device : table.devices())
    columns.push_back("published " + device), columns.push_back("x " + device);
  columns.insert(columns.end(), {"spheres %", "cube %", "truth %"});
  MarkdownTable beside(columns);
  for (const Row& row : rows) {
    const auto published = row.ok() && row.timing.timed() ? table.lookup(row) : std::map<std::string, double>();
    if (published.empty()) continue;
    const double fps = 1e3 / row.timing.median_frame_ms();
    std::vector<std::string> cells = {row.id.scene, row.id.technique, row.id.backend, std::to_string(row.id.threads)};
    for (const std::string& key : table.keys()) cells.push_back(value_of(row.id, key));
    cells.push_back("**" + three_digits(fps) + "**");
    for (const std::string& device : table.devices()) {
      const auto at = published.find(device);
      const bool known = at != published.end();
      cells.push_back(known ? fmt::format("{}", at->second) : "");
      cells.push_back(known ? three_digits(fps / at->second) : "");
    }
    cells.insert(cells.end(), {rung_or_tie(row, "spheres"), rung_or_tie(row, "cube"), rung_or_tie(row, "truth")});
    beside.add(cells);
  }
  return fmt::format("\n## Beside the published figures\n\n{}\n\n", table.title()) + beside.text();
}

}  // namespace penumbra
