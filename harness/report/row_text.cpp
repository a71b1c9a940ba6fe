#include "harness/report/row_text.h"

#include <fmt/format.h>

#include <algorithm>

#include "harness/results/statistics.h"
#include "harness/results/text.h"

namespace penumbra {

std::string telling_parameters(const Row& row, const std::vector<const Row*>& rows) {
  const auto value_in = [](const Values& values, const std::string& name) {
    const auto at = values.find(name);
    return at == values.end() ? nullptr : &at->second;
  };
  Values all_telling;
  for (const auto& [name, value] : row.id.parameters) {
    const Value* fallback = value_in(row.id.defaults, name);
    const bool telling = (fallback && *fallback != value) ||
                         std::any_of(rows.begin(), rows.end(), [&, &key = name, &own = value](const Row* other) {
                           const Value* theirs = value_in(other->id.parameters, key);
                           return other->id.technique == row.id.technique && theirs && *theirs != own;
                         });
    if (telling) all_telling[name] = value;
  }
  return describe(all_telling);
}

namespace {

/// Has another row the same technique with another value of a property?
template <class Property>
bool differs(const Row& row, const std::vector<const Row*>& rows, Property property) {
  return std::any_of(rows.begin(), rows.end(), [&](const Row* other) {
    return other->id.technique == row.id.technique && property(other->id) != property(row.id);
  });
}

}  // namespace

std::string variant_label(const Row& row, const std::vector<const Row*>& rows) {
  std::string text = row.id.technique;
  if (differs(row, rows, [](const RowIdentity& id) { return id.backend; })) text += " " + row.id.backend;
  if (const std::string parameters = telling_parameters(row, rows); !parameters.empty()) text += " " + parameters;
  const auto threads = [&](const RowIdentity& id) {
    return id.backend == row.id.backend ? id.threads : row.id.threads;
  };
  return differs(row, rows, threads) ? text + fmt::format(" threads={}", row.id.threads) : text;
}

std::string short_label(const Row& row, const std::vector<const Row*>& rows) {
  const bool telling = row.id.reads_spheres && differs(row, rows, spheres_text);
  return variant_label(row, rows) + (telling ? " spheres=" + spheres_text(row.id) : "");
}

std::string spheres_text(const RowIdentity& id) {
  if (!id.reads_spheres) return "";
  return std::to_string(id.spheres) + (id.objective.empty() ? "" : " " + id.objective);
}

std::string threads_text(const RowIdentity& id) {
  return id.threads == 0 ? "" : std::to_string(id.threads);
}

std::string median_text(const std::vector<double>& samples) {
  return samples.empty() ? "" : fmt::format("{:.3f}", median(samples));
}

std::string prepare_text(const Timing& timing) {
  return timing.prepare_ms < 0.0 ? "" : fmt::format("{:.1f}", timing.prepare_ms);
}

std::string mebibytes_text(const Row& row) {
  return row.id.external() ? "" : fmt::format("{:.1f}", double(row.facts.bytes.total()) / 1048576.0);
}

std::string milliseconds_text(const Timing& timing) {
  if (!timing.timed()) return "";
  if (timing.frame_ms.size() < 2) return fmt::format("**{:.3f}**", timing.median_frame_ms());
  const double spread = timing.frame_spread_ms();
  return fmt::format("**{:.3f}** ±{}", timing.median_frame_ms(),
                     spread < 99.5 ? fmt::format("{:.2g}", spread) : fmt::format("{:.0f}", spread));
}

std::string percent_text(const std::optional<double>& relative) {
  return relative ? fmt::format("{:.3g}", 100.0 * *relative) : "undefined";
}

std::string rung_text(const Row& row, const std::string& rung) {
  const auto at = row.score.errors.find(rung);
  return at == row.score.errors.end() ? "" : percent_text(at->second.report.all.rel_rmse);
}

namespace {

std::string tie_text(double floor) {
  return fmt::format("< {:.2g} (tie)", 100.0 * floor);
}

}  // namespace

std::string mean_or_tie(const std::vector<std::optional<double>>& relative, double floor) {
  const auto mean = mean_defined(relative);
  return mean && *mean < floor ? tie_text(floor) : percent_text(mean);
}

std::string rung_or_tie(const Row& row, const std::string& rung) {
  const auto at = row.score.errors.find(rung);
  if (at == row.score.errors.end()) return "";
  const Errors& e = at->second.report.all;
  if (at->second.tie()) return tie_text(at->second.floor());
  if (!e.rel_rmse && e.receivers > 0) return fmt::format("undefined (RMSE {:.3g})", e.rmse);
  return percent_text(e.rel_rmse);
}

std::string truth_text(const Row& row) {
  const auto error = row.score.truth_error();
  if (!error) return "undefined";
  const RungErrors& truth = row.score.errors.at("truth");
  return truth.tie() ? "< " + three_digits(100.0 * truth.floor()) : three_digits(100.0 * *error);
}

std::string geometry_text(const Row& row) {
  const auto& errors = row.score.errors;
  return errors.contains("cube") && errors.contains("spheres") ? percent_text(row.score.geometry) : "";
}

std::vector<const Row*> good_rows(const std::vector<Row>& rows) {
  std::vector<const Row*> good;
  for (const Row& row : rows)
    if (row.ok()) good.push_back(&row);
  return good;
}

std::vector<const Row*> good_rows(const std::vector<Row>& rows, const std::string& scene) {
  std::vector<const Row*> good;
  for (const Row& row : rows)
    if (row.ok() && row.id.scene == scene) good.push_back(&row);
  return good;
}

void add_distinct(const std::string& value, std::vector<std::string>& all) {
  if (std::find(all.begin(), all.end(), value) == all.end()) all.push_back(value);
}

std::vector<std::string> scenes_of(const std::vector<Row>& rows) {
  std::vector<std::string> scenes;
  for (const Row& row : rows) add_distinct(row.id.scene, scenes);
  return scenes;
}

std::vector<std::string> variant_columns() {
  return {"technique", "backend", "parameters", "threads", "spheres"};
}

std::vector<std::string> variant_cells(const Row& row, const std::vector<const Row*>& rows) {
  return {row.id.technique, row.id.backend, telling_parameters(row, rows), threads_text(row.id), spheres_text(row.id)};
}

}  // namespace penumbra
