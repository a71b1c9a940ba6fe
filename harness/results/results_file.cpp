#include "harness/results/results_file.h"

#include <simdjson.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>
#include <utility>

#include "harness/results/repetitions.h"
#include "harness/results/row_json.h"
#include "harness/results/row_reader.h"
#include "scenes/error.h"
#include "scenes/storage/atomic_write.h"

namespace penumbra {
namespace {

using nlohmann::json;
using simdjson::dom::element;

/// 2: rows in lists of their own, and an entry a repetition in `benchmarks`. Older files have no version: there, an
/// entry of `benchmarks` is a row with all that is known of it.
constexpr int format_version = 2;

/// Five times what 10,000 rows take.
constexpr std::uintmax_t largest_file = std::uintmax_t(512) << 20;

/// In which list a row stands.
enum List : std::uint8_t { measured, untimed, failed, skipped };
constexpr std::array list_names = {"rows", "untimed", "failed", "skipped"};
constexpr std::array all_lists = {measured, untimed, failed, skipped};

List list_of(const Row& row) {
  if (row.ok()) return row.timing.timed() ? measured : untimed;
  return row.skipped() ? skipped : failed;
}

/// A row without times that are none.
void check_times(Row& row) {
  const std::string why = unusable_times(row.timing);
  if (why.empty()) return;
  row.timing.update_ms.clear(), row.timing.shade_ms.clear(), row.timing.frame_ms.clear(), row.timing.stages.clear();
  row.timing.cpu_ms.clear(), row.timing.launch.clear();
  if (row.ok()) row.status = "failed: its times cannot be used: " + why;
}

/// A row's status may quote a path that is no UTF-8.
std::string text_of(const json& value) {
  return value.dump(-1, ' ', false, json::error_handler_t::replace);
}

/// The samples of a row that is measured stand in `benchmarks`.
std::string line_of(const Row& row, std::size_t index) {
  json out = to_json(row);
  out["index"] = index;
  if (list_of(row) == measured) out.erase("samples");
  return text_of(out);
}

void write_list(List list, const std::vector<Row>& rows, std::ostream& out) {
  out << '"' << list_names[list] << "\":[";
  const char* before = "\n";
  for (std::size_t k = 0; k < rows.size(); ++k)
    if (list_of(rows[k]) == list) out << std::exchange(before, ",\n") << line_of(rows[k], k);
  out << "],\n";
}

void write_entries(const std::vector<Row>& rows, std::ostream& out) {
  out << "\"benchmarks\":[";
  const char* before = "\n";
  for (std::size_t k = 0; k < rows.size(); ++k) {
    if (list_of(rows[k]) != measured) continue;
    const std::string entries = entries_of(rows[k], k);
    out << std::exchange(before, ",\n") << std::string_view(entries).substr(0, entries.size() - 2);
  }
  out << "]\n";
}

/// Rows of a list, their names as the file has them, and their places in it.
struct Read {
  std::vector<Row> rows;
  std::vector<std::string> names;
  std::vector<std::uint64_t> places;
  std::vector<List> lists;
};

void read_list(const element& file, const char* list, List kind, Read& read) {
  simdjson::dom::array lines;
  if (field(file, list).get(lines) != simdjson::SUCCESS) throw Error("its '{}' is no list", list);
  std::size_t k = 0;
  for (const element line : lines) {
    std::string_view name = "without a name";
    if (line.is_object() && line.at_key("name").get(name) != simdjson::SUCCESS) name = "without a name";
    try {
      read.rows.push_back(row_from(line));
    } catch (const Error& e) {
      throw Error("row {} of '{}', '{}': {}", k, list, name, e.what());
    }
    read.names.emplace_back(name);
    read.lists.push_back(kind);
    std::uint64_t place = 0;
    read.places.push_back(line.at_key("index").get(place) == simdjson::SUCCESS ? place : read.places.size());
    ++k;
  }
}

void check_names(const std::vector<std::string>& names) {
  std::set<std::string_view> seen;
  for (const std::string& name : names)
    if (!seen.insert(name).second) throw Error("its row '{}' stands there twice", name);
}

std::vector<Row> in_order(Read read) {
  std::vector<std::size_t> order(read.rows.size());
  for (std::size_t k = 0; k < order.size(); ++k) order[k] = k;
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return read.places[a] < read.places[b]; });
  std::vector<Row> rows;
  rows.reserve(order.size());
  for (const std::size_t k : order) rows.push_back(std::move(read.rows[k]));
  return rows;
}

/// Of every version.
std::vector<Row> rows_of(const element& file) {
  Read read;
  element version;
  if (file.at_key("format_version").get(version) != simdjson::SUCCESS) {
    read_list(file, "benchmarks", untimed, read);
    check_names(read.names);
  } else {
    if (std::int64_t number = 0; version.get(number) != simdjson::SUCCESS || number != format_version)
      throw Error("its format_version is not {}: it is of another version of penumbra", format_version);
    for (const List list : all_lists) read_list(file, list_names[list], list, read);
    check_names(read.names);
    add_repetitions(field(file, "benchmarks").get_array(), read.names, read.rows);
    for (std::size_t k = 0; k < read.rows.size(); ++k)
      if (read.lists[k] == measured && !read.rows[k].timing.timed())
        throw Error("its row '{}' was timed, and no entry of 'benchmarks' has its times", read.names[k]);
  }
  for (Row& row : read.rows) check_times(row);
  return in_order(std::move(read));
}

/// simdjson knows that a file is no JSON, nlohmann-json where it ceases to be.
std::string why_no_json(const std::string& path, const char* otherwise) {
  constexpr std::uintmax_t slow =
      32 << 20;  // the second reader takes twenty times a file's size and a second per 5 MiB
  try {
    if (std::filesystem::file_size(path) > slow) return otherwise;
    std::ifstream file(path);
    [[maybe_unused]] const json nothing = json::parse(file, [](int, json::parse_event_t, json&) { return false; });
  } catch (const std::exception& e) {
    return std::string(e.what()).substr(0, 300);
  }
  return otherwise;
}

Results parsed(const std::string& path) {
  if (!std::filesystem::is_regular_file(path)) throw Error("it is no file");
  const std::uintmax_t size = std::filesystem::file_size(path);
  if (size == 0) throw Error("it is empty");
  if (!std::ifstream(path)) throw Error("it cannot be opened: {}", std::strerror(errno));
  if (size > largest_file) throw Error("its {} MiB are more than any run writes", size >> 20);
  simdjson::dom::parser parser;
  element file;
  if (const auto error = parser.load(path).get(file))
    throw Error("no JSON: {}", why_no_json(path, simdjson::error_message(error)));
  if (!file.is_object()) throw Error("it is no JSON object");
  const element context = field(file, "context");
  if (!context.is_object()) throw Error("its 'context' is no object");
  return {json::parse(std::string(simdjson::minify(context))), rows_of(file)};
}

Results read_file(const std::string& path, const char* advice) {
  try {
    return parsed(path);
  } catch (const std::exception& e) {
    throw Error("{}: not a results file of this version ({}); {}", path, e.what(), advice);
  }
}

}  // namespace

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

void write_results(const std::string& directory, const Results& results) {
  std::vector<Row> rows = results.rows;
  for (Row& row : rows) check_times(row);
  write_atomically(directory + "/results.json", [&](std::ostream& out) {
    out << "{\"format_version\":" << format_version << ",\n\"context\":" << text_of(results.context) << ",\n";
    for (const List list : all_lists) write_list(list, rows, out);
    write_entries(rows, out);
    out << "}\n";
  });
}

Results read_results_path(const std::string& file_or_folder) {
  std::error_code fault;  // a loop of links, a name that is too long, a folder that is closed
  const bool folder = std::filesystem::is_directory(file_or_folder, fault);
  const std::string path = folder ? file_or_folder + "/results.json" : file_or_folder;
  if (!std::filesystem::exists(path, fault) || fault)
    throw Error("{}: {}; give the folder of a run, or its results.json", path,
                fault && fault != std::errc::no_such_file_or_directory ? fault.message() : "no such file");
  return read_file(path, "give the folder of a run, or its results.json");
}

Results read_results(const std::string& directory) {
  const std::string path = directory + "/results.json";
  if (!std::filesystem::exists(path)) return {};
  return read_file(path, "move it away or run without --resume");
}

}  // namespace penumbra
