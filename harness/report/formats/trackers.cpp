// JSON for services that plot a benchmark's figures commit by commit.
#include <fmt/format.h>

#include <algorithm>

#include "harness/report/formats/exported_rows.h"

namespace penumbra {
namespace {

using nlohmann::json;

constexpr double ns_per_ms = 1e6;

double noise_of(const Row& row) {
  return row.score.errors.at("truth").rel_noise.value_or(0.0);
}

/// Bencher's built-in measure of time is in nanoseconds.
json latency_of(const Timing& timing) {
  const auto [least, most] = std::minmax_element(timing.frame_ms.begin(), timing.frame_ms.end());
  return {{"value", ns_per_ms * timing.median_frame_ms()},
          {"lower_value", ns_per_ms * *least},
          {"upper_value", ns_per_ms * *most}};
}

json measures_of(const Row& row) {
  json measures = json::object();
  if (row.timing.timed()) measures["latency"] = latency_of(row.timing);
  if (const auto error = row.score.truth_error())
    measures["error"] = {{"value", *error},
                         {"lower_value", std::max(0.0, *error - noise_of(row))},
                         {"upper_value", *error + noise_of(row)}};
  if (!row.id.external()) measures["bytes"] = {{"value", row.facts.bytes.total()}};
  return measures;
}

void add_figure(const Row& row, const char* what, double value, const char* unit, double spread, json& out) {
  json figure = {{"name", row.id.name() + " " + what}, {"unit", unit}, {"value", value}};
  if (spread > 0.0) figure["range"] = fmt::format("± {:.3g}", spread);
  out.push_back(std::move(figure));
}

}  // namespace

Exported export_bmf(const std::vector<Results>& runs) {
  json out = json::object();
  for (const Row* row : measured_rows(runs.front().rows))
    if (json measures = measures_of(*row); !measures.empty()) out[row->id.name()] = std::move(measures);
  return {json_text(out), unmeasured_text(runs.front().rows)};
}

Exported export_github(const std::vector<Results>& runs) {
  json out = json::array();
  for (const Row* row : measured_rows(runs.front().rows)) {
    if (row->timing.timed())
      add_figure(*row, "time", row->timing.median_frame_ms(), "ms", row->timing.frame_spread_ms(), out);
    if (const auto error = row->score.truth_error())
      add_figure(*row, "error", 100.0 * *error, "% of RMS", 100.0 * noise_of(*row), out);
    if (!row->id.external()) add_figure(*row, "size", double(row->facts.bytes.total()), "bytes", 0.0, out);
  }
  return {json_text(out), unmeasured_text(runs.front().rows)};
}

}  // namespace penumbra
