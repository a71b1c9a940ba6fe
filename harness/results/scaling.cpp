#include "harness/results/scaling.h"

#include <algorithm>
#include <cctype>
#include <map>
#include <set>

namespace penumbra {
namespace {

constexpr const char* own_axes[] = {"spheres", "threads", "receivers"};

bool is_own_axis(const std::string& name) {
  return std::find(std::begin(own_axes), std::end(own_axes), name) != std::end(own_axes);
}

bool counts(const Row& row) {
  return row.ok() && row.timing.timed() && row.timing.median_frame_ms() > 0.0;
}

/// All that a row is but for the axis.
std::string all_but(const std::string& axis, const Row& row) {
  const RowIdentity& id = row.id;
  std::string text = axis == "receivers" ? scene_stem(id.scene) : id.scene;
  const auto add = [&](const std::string& part) { text += '\x1f' + part; };
  add(id.technique), add(id.backend);
  if (axis != "threads") add(std::to_string(id.threads));
  if (id.reads_spheres) add(id.objective);
  if (id.reads_spheres && axis != "spheres") add(std::to_string(id.spheres));
  for (const auto& [name, value] : id.parameters)
    if (name != axis) add(name + "=" + to_string(value));
  return text;
}

ScalingCurve curve_through(const std::string& axis, std::vector<const Row*> rows) {
  std::stable_sort(rows.begin(), rows.end(), [&](const Row* a, const Row* b) {
    return position_on(axis, *a).value() < position_on(axis, *b).value();
  });
  ScalingCurve curve{axis, std::move(rows), {}};
  curve.points.reserve(curve.rows.size());
  for (const Row* row : curve.rows)
    curve.points.push_back(
        {position_on(axis, *row).value(), row->timing.median_frame_ms(), row->timing.frame_spread_ms()});
  return curve;
}

/// Curves over one axis, in the order of the first row of each.
void add_curves(const std::string& axis, const std::vector<const Row*>& rows, std::vector<ScalingCurve>& curves) {
  std::map<std::string, std::size_t> places;
  std::vector<std::vector<const Row*>> groups;
  for (const Row* row : rows) {
    if (!counts(*row) || !position_on(axis, *row)) continue;
    const auto [at, fresh] = places.try_emplace(all_but(axis, *row), groups.size());
    if (fresh) groups.emplace_back();
    groups[at->second].push_back(row);
  }
  for (std::vector<const Row*>& group : groups) {
    ScalingCurve curve = curve_through(axis, std::move(group));
    if (curve.points.front().x < curve.points.back().x) curves.push_back(std::move(curve));
  }
}

/// Different techniques, alike in all else that both have but for the axis.
bool may_be_compared(const std::string& axis, const RowIdentity& a, const RowIdentity& b) {
  if (a.technique == b.technique || a.backend != b.backend || a.threads != b.threads) return false;
  return std::all_of(a.parameters.begin(), a.parameters.end(), [&](const auto& parameter) {
    const auto theirs = b.parameters.find(parameter.first);
    return parameter.first == axis || theirs == b.parameters.end() || theirs->second == parameter.second;
  });
}

/// The same time all along a curve.
std::vector<CurvePoint> level_beside(const ScalingCurve& curve, const Row& row) {
  const double ms = row.timing.median_frame_ms(), noise = row.timing.frame_spread_ms();
  return {{curve.points.front().x, ms, noise}, {curve.points.back().x, ms, noise}};
}

void add_levels(const ScalingCurve& curve, const std::vector<const Row*>& rows, std::vector<BreakEven>& found) {
  for (const Row* row : rows) {
    if (!counts(*row) || row->id.reads_spheres || !may_be_compared(curve.axis, curve.rows[0]->id, row->id)) continue;
    auto crossing = log_log_crossing(curve.points, level_beside(curve, *row));
    if (crossing.value) found.push_back({&curve, nullptr, row, std::move(crossing)});
  }
}

}  // namespace

std::optional<double> position_on(const std::string& axis, const Row& row) {
  double at = 0.0;
  if (axis == "spheres") at = row.id.reads_spheres ? double(row.id.spheres) : 0.0;
  else if (axis == "threads") at = row.id.threads;
  else if (axis == "receivers") at = double(row.id.receivers);
  else if (const auto known = row.id.parameters.find(axis); known != row.id.parameters.end()) {
    if (const int* whole = std::get_if<int>(&known->second)) at = *whole;
    else if (const double* number = std::get_if<double>(&known->second)) at = *number;
  }
  return at > 0.0 ? std::optional(at) : std::nullopt;
}

std::vector<ScalingCurve> scaling_curves(const std::vector<const Row*>& rows) {
  std::set<std::string> parameters;
  for (const Row* row : rows)
    for (const auto& [name, value] : row->id.parameters)
      if (!is_own_axis(name) && position_on(name, *row)) parameters.insert(name);
  std::vector<ScalingCurve> curves;
  add_curves("spheres", rows, curves);
  add_curves("threads", rows, curves);
  for (const std::string& name : parameters) add_curves(name, rows, curves);
  return curves;
}

std::vector<ScalingCurve> receiver_curves(const std::vector<const Row*>& rows) {
  std::vector<ScalingCurve> curves;
  add_curves("receivers", rows, curves);
  return curves;
}

std::string scene_stem(const std::string& scene) {
  std::string stem;
  for (const char c : scene) {
    const bool digit = std::isdigit(static_cast<unsigned char>(c)) != 0;
    if (!digit) stem += c;
    else if (!stem.ends_with('#')) stem += '#';
  }
  return stem;
}

std::vector<BreakEven> break_evens(const std::vector<ScalingCurve>& curves, const std::vector<const Row*>& rows) {
  std::vector<BreakEven> found;
  for (std::size_t i = 0; i < curves.size(); ++i) {
    const ScalingCurve& first = curves[i];
    if (first.axis == "threads" || first.axis == "receivers") continue;
    for (std::size_t k = i + 1; k < curves.size(); ++k)
      if (curves[k].axis == first.axis && may_be_compared(first.axis, first.rows[0]->id, curves[k].rows[0]->id))
        found.push_back({&first, &curves[k], nullptr, log_log_crossing(first.points, curves[k].points)});
    if (first.axis == "spheres") add_levels(first, rows, found);
  }
  return found;
}

}  // namespace penumbra
