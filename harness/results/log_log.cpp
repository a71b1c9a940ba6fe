#include "harness/results/log_log.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "harness/results/statistics.h"
#include "harness/results/text.h"

namespace penumbra {
namespace {

bool has_logarithm(const CurvePoint& p) {
  return std::isfinite(p.x) && std::isfinite(p.y) && p.x > 0.0 && p.y > 0.0;
}

/// Two neighbours, and how far x lies from the first to the second of them on the logarithmic axis.
struct Place {
  const CurvePoint *below, *above;
  double share;
};

std::optional<Place> place_of(const std::vector<CurvePoint>& points, double x) {
  if (points.empty() || !(x >= points.front().x && x <= points.back().x)) return std::nullopt;
  const auto above =
      std::lower_bound(points.begin(), points.end(), x, [](const CurvePoint& p, double value) { return p.x < value; });
  if (above->x == x) return Place{&*above, &*above, 0.0};
  const auto below = above - 1;
  return Place{&*below, &*above, std::log(x / below->x) / std::log(above->x / below->x)};
}

double y_at(const Place& place) {
  if (place.below == place.above) return place.below->y;
  return std::exp(std::lerp(std::log(place.below->y), std::log(place.above->y), place.share));
}

/// As a share of y.
double noise_at(const Place& place) {
  return std::lerp(place.below->noise / place.below->y, place.above->noise / place.above->y, place.share);
}

/// Ascending in x, each x once.
std::vector<CurvePoint> curve_of(std::vector<CurvePoint> points) {
  std::erase_if(points, [](const CurvePoint& p) { return !has_logarithm(p); });
  std::sort(points.begin(), points.end(),
            [](const CurvePoint& a, const CurvePoint& b) { return std::pair(a.x, a.y) < std::pair(b.x, b.y); });
  const auto same = [](const CurvePoint& a, const CurvePoint& b) { return a.x == b.x; };
  points.erase(std::unique(points.begin(), points.end(), same), points.end());
  return points;
}

/// How two curves differ at an x: log(first / second), and whether that is more than noise.
struct Gap {
  double x, log_ratio;
  bool clear;
};

std::vector<Gap> gaps_between(const std::vector<CurvePoint>& first, const std::vector<CurvePoint>& second, double low,
                              double high) {
  std::set<double> all = {low, high};
  for (const auto* curve : {&first, &second})
    for (const CurvePoint& p : *curve)
      if (p.x > low && p.x < high) all.insert(p.x);
  std::vector<Gap> gaps;
  gaps.reserve(all.size());
  for (const double x : all) {
    const Place a = *place_of(first, x), b = *place_of(second, x);
    const double ya = y_at(a), yb = y_at(b), noise = ya * noise_at(a) + yb * noise_at(b);
    gaps.push_back({x, ya == yb ? 0.0 : std::log(ya / yb), std::abs(ya - yb) > noise});
  }
  return gaps;
}

/// The gaps on both sides of each change of sign; those of 0 are skipped.
std::vector<std::pair<std::size_t, std::size_t>> changes_of_sign(const std::vector<Gap>& gaps) {
  std::vector<std::pair<std::size_t, std::size_t>> changes;
  std::optional<std::size_t> last;
  for (std::size_t k = 0; k < gaps.size(); ++k) {
    if (gaps[k].log_ratio == 0.0) continue;
    if (last && (gaps[*last].log_ratio < 0.0) != (gaps[k].log_ratio < 0.0)) changes.emplace_back(*last, k);
    last = k;
  }
  return changes;
}

std::string never(const std::vector<Gap>& gaps) {
  const auto differs = std::find_if(gaps.begin(), gaps.end(), [](const Gap& gap) { return gap.log_ratio != 0.0; });
  const std::string range = fmt::format("from {} to {}", three_digits(gaps.front().x), three_digits(gaps.back().x));
  if (differs == gaps.end()) return "both are equal " + range;
  return fmt::format("they never cross {}: the {} is less", range, differs->log_ratio < 0.0 ? "first" : "second");
}

/// Does one side of a crossing differ by more than noise anywhere?
bool clear_on(bool negative, const std::vector<Gap>& gaps) {
  return std::any_of(gaps.begin(), gaps.end(),
                     [&](const Gap& gap) { return gap.clear && (gap.log_ratio < 0.0) == negative; });
}

}  // namespace

std::optional<double> log_log_at(const std::vector<CurvePoint>& points, double x) {
  const auto place = place_of(points, x);
  return place ? std::optional(y_at(*place)) : std::nullopt;
}

OrReason<Slope> log_log_slope(const std::vector<CurvePoint>& points) {
  std::vector<std::pair<double, double>> logs;
  std::set<double> different;
  double mean_x = 0.0, mean_y = 0.0;
  for (const CurvePoint& p : points) {
    if (!has_logarithm(p)) continue;
    logs.emplace_back(std::log(p.x), std::log(p.y));
    different.insert(p.x);
    mean_x += logs.back().first, mean_y += logs.back().second;
  }
  if (different.size() < 3)
    return OrReason<Slope>::refuse(
        fmt::format("a slope with its interval needs three different values, and there are {}", different.size()));
  const auto n = double(logs.size());
  mean_x /= n, mean_y /= n;
  double xx = 0.0, xy = 0.0, residual = 0.0;
  for (const auto& [x, y] : logs) xx += (x - mean_x) * (x - mean_x), xy += (x - mean_x) * (y - mean_y);
  const double slope = xy / xx;
  for (const auto& [x, y] : logs) residual += std::pow(y - mean_y - slope * (x - mean_x), 2);
  const double reach = student_quantile(0.95, n - 2.0) * std::sqrt(residual / (n - 2.0) / xx);
  return OrReason<Slope>::of({slope, slope - reach, slope + reach});
}

OrReason<Crossing> log_log_crossing(const std::vector<CurvePoint>& points_of_first,
                                    const std::vector<CurvePoint>& points_of_second) {
  const auto refuse = OrReason<Crossing>::refuse;
  const std::vector<CurvePoint> first = curve_of(points_of_first), second = curve_of(points_of_second);
  if (first.empty() || second.empty()) return refuse("one of the two has no point");
  const double low = std::max(first.front().x, second.front().x), high = std::min(first.back().x, second.back().x);
  if (!(low < high))
    return refuse(fmt::format("the measured ranges, {} to {} and {} to {}, have no stretch in common",
                              three_digits(first.front().x), three_digits(first.back().x),
                              three_digits(second.front().x), three_digits(second.back().x)));
  const std::vector<Gap> gaps = gaps_between(first, second, low, high);
  const auto changes = changes_of_sign(gaps);
  if (changes.empty()) return refuse(never(gaps));
  if (changes.size() > 1)
    return refuse(
        fmt::format("they cross {} times from {} to {}", changes.size(), three_digits(low), three_digits(high)));
  const auto [k, m] = changes.front();
  const Gap &before = gaps[k], &after = gaps[m];
  if (m > k + 2)
    return refuse(
        fmt::format("they run together from {} to {}", three_digits(gaps[k + 1].x), three_digits(gaps[m - 1].x)));
  if (!clear_on(true, gaps) || !clear_on(false, gaps))
    return refuse("on one side of their crossing they differ by no more than their noise");
  const bool first_is_less = before.log_ratio < 0.0;
  if (m == k + 2) return OrReason<Crossing>::of({gaps[k + 1].x, first_is_less});
  const double share = before.log_ratio / (before.log_ratio - after.log_ratio);
  return OrReason<Crossing>::of({before.x * std::pow(after.x / before.x, share), first_is_less});
}

}  // namespace penumbra
