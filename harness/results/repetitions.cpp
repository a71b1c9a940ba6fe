#include "harness/results/repetitions.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <unordered_map>

#include "harness/results/row_reader.h"
#include "harness/results/statistics.h"
#include "scenes/error.h"

namespace penumbra {
namespace {

using simdjson::dom::element;

struct Aggregate {
  const char *name, *unit;
  double (*of)(const std::vector<double>& values);
};

double mean(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double value : values) sum += value;
  return sum / double(values.size());
}

double standard_deviation(const std::vector<double>& values) {
  const double centre = mean(values);
  double sum = 0.0;
  for (const double value : values) sum += (value - centre) * (value - centre);
  return std::sqrt(sum / double(values.size() - 1));
}

double median_of(const std::vector<double>& values) {
  return median(values);
}

double variation(const std::vector<double>& values) {
  return standard_deviation(values) / mean(values);
}

constexpr std::array aggregates = {Aggregate{"mean", "time", mean}, Aggregate{"median", "time", median_of},
                                   Aggregate{"stddev", "time", standard_deviation},
                                   Aggregate{"cv", "percentage", variation}};

/// In quotes; bytes that are no UTF-8 are replaced.
std::string quoted(const std::string& text) {
  return nlohmann::json(text).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

bool is_time(double ms) {
  return std::isfinite(ms) && ms >= 0.0;
}

std::string unusable(const char* what, const std::vector<double>& ms, std::size_t repetitions) {
  if (!ms.empty() && ms.size() != repetitions)
    return fmt::format("{} repetitions, and {} times of {}", repetitions, ms.size(), what);
  for (std::size_t k = 0; k < ms.size(); ++k)
    if (!is_time(ms[k])) return fmt::format("{} of repetition {} took {} ms", what, k, ms[k]);
  return "";
}

/// null and words are no time; the row says so.
double time_in(const element& value) {
  double ms = 0.0;
  return value.get(ms) == simdjson::SUCCESS ? ms : std::numeric_limits<double>::quiet_NaN();
}

void add_repetition(const element& entry, Timing& timing) {
  if (text_of(entry, "time_unit") != "ms") throw Error("its field 'time_unit' is not 'ms'");
  timing.frame_ms.push_back(time_in(field(entry, "real_time")));
  for (const auto& [name, times] :
       {std::pair("update_ms", &timing.update_ms), {"shade_ms", &timing.shade_ms}, {"cpu_ms", &timing.cpu_ms}})
    if (element value; entry.at_key(name).get(value) == simdjson::SUCCESS) times->push_back(time_in(value));
  if (std::int64_t launch = 0; entry.at_key("launch").get(launch) == simdjson::SUCCESS)
    timing.launch.push_back(int(launch));
}

}  // namespace

std::string unusable_times(const Timing& t) {
  for (std::size_t k = 0; k < t.frame_ms.size(); ++k)
    if (!is_time(t.frame_ms[k]) || t.frame_ms[k] == 0.0)
      return fmt::format("repetition {} took {} ms", k, t.frame_ms[k]);
  if (std::string why = unusable("update", t.update_ms, t.frame_ms.size()); !why.empty()) return why;
  if (std::string why = unusable("processors", t.cpu_ms, t.frame_ms.size()); !why.empty()) return why;
  if (!t.launch.empty() && t.launch.size() != t.frame_ms.size())
    return fmt::format("{} repetitions, and {} numbers of launches", t.frame_ms.size(), t.launch.size());
  return unusable("shade", t.shade_ms, t.frame_ms.size());
}

std::string entries_of(const Row& row, std::size_t family) {
  const std::string name = row.id.name();
  const Timing& t = row.timing;
  const std::string head =
      fmt::format(R"("family_index":{},"per_family_instance_index":0,"run_name":{})", family, quoted(name));
  const std::string counts = fmt::format(R"("repetitions":{})", t.frame_ms.size());
  fmt::memory_buffer out;
  const auto put = [&](auto text, const auto&... values) { fmt::format_to(std::back_inserter(out), text, values...); };
  const std::string quoted_name = quoted(name);
  for (std::size_t k = 0; k < t.frame_ms.size(); ++k) {
    put(FMT_STRING(R"({{"name":{},{},"run_type":"iteration",{},"repetition_index":{},"threads":{},"iterations":{},)"),
        quoted_name, head, counts, k, row.id.threads, t.iterations);
    put(FMT_STRING(R"("real_time":{},"cpu_time":{},"time_unit":"ms")"), t.frame_ms[k], t.frame_ms[k]);
    if (!t.update_ms.empty()) put(FMT_STRING(R"(,"update_ms":{})"), t.update_ms[k]);
    if (!t.shade_ms.empty()) put(FMT_STRING(R"(,"shade_ms":{})"), t.shade_ms[k]);
    if (!t.cpu_ms.empty()) put(FMT_STRING(R"(,"cpu_ms":{})"), t.cpu_ms[k]);
    if (!t.launch.empty()) put(FMT_STRING(R"(,"launch":{})"), t.launch[k]);
    put(FMT_STRING("}},\n"));
  }
  if (t.frame_ms.size() < 2) return fmt::to_string(out);
  for (const Aggregate& a : aggregates) {
    put(FMT_STRING(R"({{"name":{},{},"run_type":"aggregate",{},"threads":{},"aggregate_name":"{}",)"),
        quoted(name + "_" + a.name), head, counts, row.id.threads, a.name);
    put(FMT_STRING(R"("aggregate_unit":"{}","iterations":{},"real_time":{},"cpu_time":{},"time_unit":"ms"}},)"
                   "\n"),
        a.unit, t.frame_ms.size(), a.of(t.frame_ms), a.of(t.frame_ms));
  }
  return fmt::to_string(out);
}

void add_repetitions(const simdjson::dom::array& entries, const std::vector<std::string>& names,
                     std::vector<Row>& rows) {
  std::unordered_map<std::string_view, Row*> by_name;
  for (std::size_t k = 0; k < rows.size(); ++k) by_name.emplace(names[k], &rows[k]);
  for (const element entry : entries) {
    if (text_of(entry, "run_type") == "aggregate") continue;
    const std::string name = text_of(entry, "run_name");
    const auto at = by_name.find(name);
    if (at == by_name.end()) throw Error("'benchmarks' has an entry '{}', which is no row", name);
    try {
      add_repetition(entry, at->second->timing);
    } catch (const Error& e) {
      throw Error("entry '{}' of 'benchmarks': {}", name, e.what());
    }
  }
}

}  // namespace penumbra
