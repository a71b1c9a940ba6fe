#include "harness/report/figures.h"

#include <algorithm>
#include <limits>
#include <map>

#include "harness/report/published_figures.h"
#include "harness/report/row_text.h"
#include "harness/report/scaling_figures.h"
#include "harness/results/derived.h"
#include "harness/results/tradeoff.h"

namespace penumbra {
namespace {

using nlohmann::json;

constexpr double limits[] = {0.01, 0.02, 0.03, 0.1};                        // relative errors
constexpr double budgets_ms[] = {0.1, 1.0, 1e3 / 60.0, 1e3 / 30.0, 100.0};  // the middle ones are 60 and 30 frames/s

/// {KEY: value, "bound": where it is one}, or {"refused": why}.
json with_figure(json out, const char* key, const OrReason<Bounded>& figure) {
  if (!figure.value) {
    out["refused"] = figure.refused;
    return out;
  }
  out[key] = figure.value->value;
  if (figure.value->bound != Bound::exact) out["bound"] = to_string(figure.value->bound);
  return out;
}

json names_of(const std::vector<TradePoint>& envelope) {
  json names = json::array();
  for (const TradePoint& point : envelope) names.push_back(point.row->id.name());
  return names;
}

/// By median of the frame; rows without a time come last.
std::vector<const Row*> by_time(const std::vector<const Row*>& rows) {
  std::vector<std::pair<double, const Row*>> sorted;
  sorted.reserve(rows.size());
  for (const Row* row : rows)
    sorted.emplace_back(row->timing.timed() ? row->timing.median_frame_ms() : std::numeric_limits<double>::infinity(),
                        row);
  std::stable_sort(sorted.begin(), sorted.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<const Row*> all;
  all.reserve(rows.size());
  for (const auto& [ms, row] : sorted) all.push_back(row);
  return all;
}

/// The noise of a scene's truth and the error up to which rows are ties: of the rows, the largest.
void add_noise(const std::vector<const Row*>& rows, json& out) {
  out["truth_noise"] = out["floor"] = nullptr;
  double most = -1.0;
  for (const Row* row : rows) {
    const auto truth = row->score.errors.find("truth");
    if (truth == row->score.errors.end() || truth->second.rel_noise.value_or(-1.0) <= most) continue;
    most = *truth->second.rel_noise;
    out["truth_noise"] = most, out["floor"] = truth->second.floor();
  }
}

json pareto_json(const std::vector<const Row*>& rows) {
  json names = json::array();
  const std::vector<bool> optimal = pareto_optimal(rows);
  for (std::size_t k = 0; k < rows.size(); ++k)
    if (optimal[k]) names.push_back(rows[k]->id.name());
  return names;
}

json cheapest_json(const std::vector<const Row*>& rows) {
  json all = json::array();
  for (const double limit : limits) {
    const Row* best = best_within(limit, rows);
    all.push_back({{"limit", limit}, {"row", best ? json(best->id.name()) : json()}});
  }
  return all;
}

/// Of all rows but those of the reference itself.
json speed_up_json(const std::vector<const Row*>& rows, const std::vector<TradePoint>& curve,
                   const std::string& reference) {
  json all = json::array();
  for (const Row* row : rows) {
    if (row->id.technique == reference) continue;
    const auto error = row->score.truth_error();
    auto factor = speed_up(*row, curve);
    if (curve.empty() && trade_point(*row).value)
      factor.refused = "no row of " + reference + " has a time and an error";
    all.push_back(with_figure({{"row", row->id.name()}, {"error", error ? json(*error) : json()}}, "factor", factor));
  }
  return all;
}

json family_json(const std::vector<const Row*>& rows) {
  const std::vector<TradePoint> envelope = lower_envelope(rows);
  json out = {{"technique", rows.front()->id.technique},
              {"backend", rows.front()->id.backend},
              {"rows", names_of(envelope)},
              {"time_at_error", json::array()},
              {"error_at_time", json::array()}};
  for (const double error : limits)
    out["time_at_error"].push_back(with_figure({{"error", error}}, "ms", time_at_error(error, envelope)));
  for (const double ms : budgets_ms)
    out["error_at_time"].push_back(with_figure({{"ms", ms}}, "error", error_at_time(ms, envelope)));
  return out;
}

/// In the order in which their fastest rows come.
json families_json(const std::vector<const Row*>& rows) {
  std::map<std::pair<std::string, std::string>, std::size_t> places;
  std::vector<std::vector<const Row*>> families;
  for (const Row* row : rows) {
    const auto [at, fresh] = places.try_emplace({row->id.technique, row->id.backend}, families.size());
    if (fresh) families.emplace_back();
    families[at->second].push_back(row);
  }
  json all = json::array();
  for (const auto& family : families) all.push_back(family_json(family));
  return all;
}

json scene_json(const std::string& scene, const std::vector<Row>& all, const std::string& reference) {
  const std::vector<const Row*> rows = by_time(good_rows(all, scene));
  std::vector<const Row*> of_reference;
  std::copy_if(rows.begin(), rows.end(), std::back_inserter(of_reference),
               [&](const Row* row) { return row->id.technique == reference; });
  const std::vector<TradePoint> curve = lower_envelope(most_efficient(of_reference));
  json out = {{"scene", scene}, {"rows", json::array()}};
  for (const Row* row : rows) out["rows"].push_back(row->id.name());
  add_noise(rows, out);
  out["pareto"] = pareto_json(rows);
  out["cheapest"] = cheapest_json(rows);
  out["ray_traced"] = names_of(curve);
  out["speed_up"] = speed_up_json(rows, curve, reference);
  out["families"] = families_json(rows);
  ScalingFigures scaling = make_scaling_figures(rows);
  out["scaling"] = std::move(scaling.scaling);
  out["break_even"] = std::move(scaling.break_even);
  return out;
}

}  // namespace

json make_figures(const Results& results, const std::string& reference) {
  json out = {{"format_version", 1},
              {"limits", limits},
              {"budgets_ms", budgets_ms},
              {"reference", reference},
              {"scenes", json::array()}};
  for (const std::string& scene : scenes_of(results.rows))
    out["scenes"].push_back(scene_json(scene, results.rows, reference));
  out["receivers_scaling"] = make_receiver_figures(good_rows(results.rows));
  out["published"] = make_published_figures(results);
  return out;
}

}  // namespace penumbra
