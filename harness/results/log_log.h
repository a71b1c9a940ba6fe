// Curves through measured points on logarithmic axes: read between the points, never beyond them.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace penumbra {

/// A figure, or why there is none.
template <class T>
struct OrReason {
  std::optional<T> value;
  std::string refused;  ///< in words; empty if there is a value

  static OrReason of(T found) { return {std::move(found), {}}; }
  static OrReason refuse(std::string why) { return {std::nullopt, std::move(why)}; }
};

/// A measured point: both coordinates are positive. `noise` is that of y, in y's unit.
struct CurvePoint {
  double x = 0.0, y = 0.0, noise = 0.0;
};

/// y at x on the straight lines between the logarithms of neighbours; the measured y at a point, and empty outside of
/// the points' range. Their x ascend, each once.
std::optional<double> log_log_at(const std::vector<CurvePoint>& points, double x);

/// y grows as x to the power of `slope`, with 95 % confidence between `low` and `high`.
struct Slope {
  double slope = 0.0, low = 0.0, high = 0.0;
};

/// Least squares on the logarithms; the interval is Student's with n - 2 degrees of freedom. In any order. Points that
/// have no logarithm are left out; refused for fewer than three different x.
OrReason<Slope> log_log_slope(const std::vector<CurvePoint>& points);

/// Where two curves cross. Below `at`, the first curve has the lesser y, or the second.
struct Crossing {
  double at = 0.0;
  bool first_is_less_below = false;
};

/// The one x at which the piecewise straight log-log curves cross; of points with the same x, the least y counts.
/// Refused where the measured ranges have no stretch in common, the curves never cross, cross more than once, run
/// together for a stretch, or on one side of the crossing differ nowhere by more than the noise of both.
OrReason<Crossing> log_log_crossing(const std::vector<CurvePoint>& first, const std::vector<CurvePoint>& second);

}  // namespace penumbra
