#include "harness/report/scaling_figures.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <map>

#include "harness/report/row_text.h"
#include "harness/results/scaling.h"

namespace penumbra {
namespace {

using nlohmann::json;

/// Says what a curve holds: what all of its rows have, where others of its technique differ.
class Holding {
 public:
  explicit Holding(const std::vector<const Row*>& rows) {
    for (const Row* row : rows) by_technique_[row->id.technique].push_back(row);
  }

  std::string text(const Row& row, const std::string& axis) const {
    Row held;
    held.id = row.id;
    held.id.parameters.erase(axis);
    std::vector<std::string> parts;
    if (axis != "spheres" && !spheres_text(row.id).empty()) parts.push_back(spheres_text(row.id) + " spheres");
    if (axis == "spheres" && !row.id.objective.empty()) parts.push_back(row.id.objective);
    if (const auto told = telling_parameters(held, by_technique_.at(row.id.technique)); !told.empty())
      parts.push_back(told);
    if (axis != "threads" && row.id.threads > 0)
      parts.push_back(fmt::format("{} thread{}", row.id.threads, row.id.threads == 1 ? "" : "s"));
    return fmt::format("{}", fmt::join(parts, ", "));
  }

  std::string label(const Row& row, const std::string& axis) const {
    const std::string held = text(row, axis);
    return row.id.technique + " " + row.id.backend + (held.empty() ? "" : " (" + held + ")");
  }

 private:
  std::map<std::string, std::vector<const Row*>> by_technique_;
};

json curve_json(const ScalingCurve& curve, const Holding& holding) {
  const Row& row = *curve.rows.front();
  json out = {{"axis", curve.axis},
              {"technique", row.id.technique},
              {"backend", row.id.backend},
              {"threads", curve.axis == "threads" ? json() : json(row.id.threads)},
              {"fixed", holding.text(row, curve.axis)}};
  for (const Row* at : curve.rows) out["rows"].push_back(at->id.name());
  for (const CurvePoint& point : curve.points) out["points"].push_back({point.x, point.y});
  const auto fit = log_log_slope(curve.points);
  if (fit.value) out["slope"] = fit.value->slope, out["low"] = fit.value->low, out["high"] = fit.value->high;
  else out["refused"] = fit.refused;
  return out;
}

json break_even_json(const BreakEven& found, const Holding& holding) {
  const std::string& axis = found.first->axis;
  const Row& second = found.second ? *found.second->rows.front() : *found.level;
  json out = {{"axis", axis},
              {"first", holding.label(*found.first->rows.front(), axis)},
              {"second", holding.label(second, axis)}};
  if (const auto& crossing = found.crossing.value) {
    out["at"] = crossing->at;
    out["faster_below"] = crossing->first_is_less_below ? "first" : "second";
  } else {
    out["refused"] = found.crossing.refused;
  }
  return out;
}

}  // namespace

ScalingFigures make_scaling_figures(const std::vector<const Row*>& rows) {
  const Holding holding(rows);
  const std::vector<ScalingCurve> curves = scaling_curves(rows);
  ScalingFigures figures{json::array(), json::array()};
  for (const ScalingCurve& curve : curves) figures.scaling.push_back(curve_json(curve, holding));
  for (const BreakEven& found : break_evens(curves, rows))
    figures.break_even.push_back(break_even_json(found, holding));
  return figures;
}

json make_receiver_figures(const std::vector<const Row*>& rows) {
  const Holding holding(rows);
  json all = json::array();
  for (const ScalingCurve& curve : receiver_curves(rows)) {
    json out = curve_json(curve, holding);
    for (const Row* row : curve.rows) out["scenes"].push_back(row->id.scene);
    all.push_back(std::move(out));
  }
  return all;
}

}  // namespace penumbra
