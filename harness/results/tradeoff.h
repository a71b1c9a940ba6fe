// Time against error along a curve of rows: what one costs at a given other. Read between measured rows, never beyond.
#pragma once

#include <string>
#include <vector>

#include "harness/results/log_log.h"
#include "harness/results/row.h"

namespace penumbra {

/// A row as a point of a curve.
struct TradePoint {
  const Row* row = nullptr;
  double ms = 0.0;     ///< median of the frame
  double error = 0.0;  ///< relative RMSE against truth, or the floor of that truth where it is a tie
  bool tie = false;    ///< the error is at most the floor; how much less, the truth cannot tell
};

/// A figure that may be a bound because a tie is in it.
enum class Bound { exact, at_most, at_least, of_ties };
struct Bounded {
  double value = 0.0;
  Bound bound = Bound::exact;
};
std::string to_string(Bound bound);  ///< "", "at most", "at least", "of ties"

/// The row as a point, or why it is none: it failed, has no time, its error is undefined, or 0 without a floor.
OrReason<TradePoint> trade_point(const Row& row);

/// The rows that are nearer than every faster one, by time; times ascend and errors descend, each strictly. Rows that
/// are no points are left out. Medians alone count here, unlike in pareto_optimal(): a curve has one point a place.
std::vector<TradePoint> lower_envelope(const std::vector<const Row*>& rows);

/// Milliseconds at which a curve reaches a relative error, on the straight log-log line between its neighbours. At most
/// that if one of the two is a tie. Refused outside of the errors of the curve.
OrReason<Bounded> time_at_error(double error, const std::vector<TradePoint>& envelope);

/// The relative error that a curve has reached at a time in milliseconds; the same.
OrReason<Bounded> error_at_time(double ms, const std::vector<TradePoint>& envelope);

/// How many times as long as the row the curve takes to reach the row's error. At least that if the row is a tie, at
/// most if only the curve's neighbour is; of ties if both are. Refused where time_at_error() or trade_point() is.
OrReason<Bounded> speed_up(const Row& row, const std::vector<TradePoint>& envelope);

/// Of some rows, those of the backend and threads that reach an error fastest: the least median of time times squared
/// error, which for independent samples does not depend on their number (efficiency of a Monte Carlo estimator). Those
/// with less than half as many rows as another make no curve beside it, and do not count.
std::vector<const Row*> most_efficient(const std::vector<const Row*>& rows);

}  // namespace penumbra
