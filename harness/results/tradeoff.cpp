#include "harness/results/tradeoff.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "harness/results/statistics.h"
#include "harness/results/text.h"

namespace penumbra {
namespace {

std::string percent(double relative) {
  return three_digits(100.0 * relative) + " %";
}

/// "below the measured errors, 1 % to 10 %"
std::string outside(const char* what, bool below, const std::string& least, const std::string& most) {
  const std::string range = least == most ? least + " alone" : least + " to " + most;
  return fmt::format("{} the measured {}, {}", below ? "below" : "above", what, range);
}

/// A figure of a curve is a bound if a tie is next to where it is read.
Bound bound_at(const std::vector<TradePoint>& envelope, double at, double TradePoint::*axis) {
  for (std::size_t k = 0; k < envelope.size(); ++k) {
    if (envelope[k].*axis == at) return envelope[k].tie ? Bound::at_most : Bound::exact;
    const bool between = k > 0 && std::min(envelope[k - 1].*axis, envelope[k].*axis) < at &&
                         at < std::max(envelope[k - 1].*axis, envelope[k].*axis);
    if (between) return envelope[k - 1].tie || envelope[k].tie ? Bound::at_most : Bound::exact;
  }
  return Bound::exact;
}

}  // namespace

std::string to_string(Bound bound) {
  constexpr const char* names[] = {"", "at most", "at least", "of ties"};
  return names[int(bound)];
}

OrReason<TradePoint> trade_point(const Row& row) {
  const auto refuse = OrReason<TradePoint>::refuse;
  if (!row.ok()) return refuse("it was not measured");
  const double ms = row.timing.median_frame_ms();
  if (!row.timing.timed()) return refuse("it has no time");
  if (!(ms > 0.0) || !std::isfinite(ms)) return refuse("its time cannot be used");
  const auto error = row.score.truth_error();
  if (!error || !std::isfinite(*error) || *error < 0.0) return refuse("its error is undefined");
  const RungErrors& truth = row.score.errors.at("truth");
  const double known = std::max(*error, truth.floor());
  if (!(known > 0.0)) return refuse("its error is 0, which has no place on a logarithmic axis");
  return OrReason<TradePoint>::of({&row, ms, known, truth.tie()});
}

std::vector<TradePoint> lower_envelope(const std::vector<const Row*>& rows) {
  std::vector<TradePoint> points;
  points.reserve(rows.size());
  for (const Row* row : rows)
    if (const auto point = trade_point(*row); point.value) points.push_back(*point.value);
  std::stable_sort(points.begin(), points.end(), [](const TradePoint& a, const TradePoint& b) {
    return std::pair(a.ms, a.error) < std::pair(b.ms, b.error);
  });
  std::vector<TradePoint> envelope;
  envelope.reserve(points.size());
  for (const TradePoint& point : points)
    if (envelope.empty() || point.error < envelope.back().error) envelope.push_back(point);
  return envelope;
}

OrReason<Bounded> time_at_error(double error, const std::vector<TradePoint>& envelope) {
  const auto refuse = OrReason<Bounded>::refuse;
  if (envelope.empty()) return refuse("no row has a time and an error");
  if (!(error > 0.0)) return refuse("an error of 0 has no place on a logarithmic axis");
  std::vector<CurvePoint> points;
  points.reserve(envelope.size());
  for (auto at = envelope.rbegin(); at != envelope.rend(); ++at) points.push_back({at->error, at->ms});
  if (const auto ms = log_log_at(points, error))
    return OrReason<Bounded>::of({*ms, bound_at(envelope, error, &TradePoint::error)});
  return refuse(percent(error) + " is " +
                outside("errors", error < points.front().x, percent(points.front().x), percent(points.back().x)));
}

OrReason<Bounded> error_at_time(double ms, const std::vector<TradePoint>& envelope) {
  const auto refuse = OrReason<Bounded>::refuse;
  if (envelope.empty()) return refuse("no row has a time and an error");
  std::vector<CurvePoint> points;
  points.reserve(envelope.size());
  for (const TradePoint& point : envelope) points.push_back({point.ms, point.error});
  if (const auto error = log_log_at(points, ms))
    return OrReason<Bounded>::of({*error, bound_at(envelope, ms, &TradePoint::ms)});
  return refuse(three_digits(ms) + " ms is " +
                outside("times", !(ms > points.back().x), three_digits(points.front().x) + " ms",
                        three_digits(points.back().x) + " ms"));
}

OrReason<Bounded> speed_up(const Row& row, const std::vector<TradePoint>& envelope) {
  const auto own = trade_point(row);
  if (!own.value) return OrReason<Bounded>::refuse(own.refused);
  auto curve = time_at_error(own.value->error, envelope);
  if (!curve.value) return curve;
  const bool curve_ties = curve.value->bound == Bound::at_most;
  curve.value->value /= own.value->ms;
  if (own.value->tie) curve.value->bound = curve_ties ? Bound::of_ties : Bound::at_least;
  return curve;
}

std::vector<const Row*> most_efficient(const std::vector<const Row*>& rows) {
  struct Group {
    std::vector<const Row*> rows;
    std::vector<double> costs;  ///< ms times squared error
  };
  std::map<std::pair<std::string, int>, Group> groups;
  for (const Row* row : rows) {
    const auto point = trade_point(*row);
    if (!point.value) continue;
    Group& group = groups[{row->id.backend, row->id.threads}];
    group.rows.push_back(row);
    group.costs.push_back(point.value->ms * point.value->error * point.value->error);
  }
  std::size_t most = 0;
  for (const auto& [key, group] : groups) most = std::max(most, group.rows.size());
  double least = std::numeric_limits<double>::infinity();
  std::vector<const Row*> best;
  for (const auto& [key, group] : groups)
    if (const double cost = median(group.costs); cost < least && 2 * group.rows.size() >= most)
      least = cost, best = group.rows;
  return best;
}

}  // namespace penumbra
