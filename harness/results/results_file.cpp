#include "harness/results/results_file.h"

#include <filesystem>
#include <fstream>
#include <map>

#include "harness/results/row_json.h"
#include "scenes/error.h"

namespace penumbra {

using nlohmann::json;

std::vector<Row> merged(std::vector<Row> rows, const std::vector<Row>& more) {
  std::map<std::string, std::size_t> places;
  for (std::size_t k = 0; k < rows.size(); ++k) places.emplace(rows[k].id.name(), k);
  for (const Row& row : more) {
    const auto [at, fresh] = places.emplace(row.id.name(), rows.size());
    if (fresh) rows.push_back(row);
    else rows[at->second] = row;
  }
  return rows;
}

void write_atomically(const std::string& path, const std::string& text) {
  const std::string partial = path + ".partial";
  std::ofstream out(partial);
  out << text;
  out.close();
  if (!out) throw Error("{}: cannot be written", path);
  std::filesystem::rename(partial, path);
}

void write_results(const std::string& directory, const Results& results) {
  json out = {{"context", results.context}, {"benchmarks", json::array()}};
  for (const Row& row : results.rows) out["benchmarks"].push_back(to_json(row));
  // A row's status may quote a path that is no UTF-8.
  write_atomically(directory + "/results.json", out.dump(1, ' ', false, json::error_handler_t::replace) + "\n");
}

Results read_results(const std::string& directory) {
  const std::string path = directory + "/results.json";
  if (!std::filesystem::exists(path)) return {};
  try {
    Results results;
    const json file = json::parse(std::ifstream(path));
    results.context = file.at("context").get<json::object_t>();
    for (const json& row : file.at("benchmarks").get<json::array_t>()) results.rows.push_back(row_from_json(row));
    return results;
  } catch (const std::exception& e) {
    throw Error("{}: not a results file of this version ({}); move it away or run without --resume", path, e.what());
  }
}

}  // namespace penumbra
