#include "harness/compare/verdict.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <tuple>

#include "harness/results/statistics.h"

namespace penumbra {
namespace {

constexpr double level = 0.95;

/// Why samples cannot be used; empty if they can.
std::string fault_of(const char* whose, const std::vector<double>& samples) {
  if (samples.empty()) return fmt::format("{} has no time", whose);
  for (const double ms : samples)
    if (!std::isfinite(ms) || ms <= 0.0) return fmt::format("{} has a frame of {} ms", whose, ms);
  return samples.size() < 2 ? fmt::format("{} has one sample, which has no spread", whose) : "";
}

/// Standard error of a RMSE that has been told with six digits, and of sums in another order.
double rounding(double error, double signal) {
  return 1e-4 * error + 1e-6 * signal;
}

/// One error to compare, in units of the image.
struct Scored {
  std::string rung;
  double error = 0.0, noise = 0.0, signal = 0.0;
  std::size_t receivers = 0;
  std::optional<double> relative;

  double floor() const { return std::numbers::sqrt2 * noise; }
  double above_noise() const { return std::max(error, floor()); }
};

/// Why an error cannot be used; empty if it can.
std::string fault_of(const Scored& scored) {
  if (!(scored.error >= 0.0 && std::isfinite(scored.error))) return "is no number";
  if (!(scored.noise >= 0.0 && std::isfinite(scored.noise))) return "has a noise that is no number";
  const bool zero = scored.error == 0.0;
  return scored.relative && zero != (*scored.relative == 0.0) ? "and its share of the reference contradict each other"
                                                              : "";
}

Scored scored(const std::string& rung, const RungErrors& errors) {
  const Errors& all = errors.report.all;
  const double signal = all.rel_rmse && *all.rel_rmse > 0.0 ? all.rmse / *all.rel_rmse : 0.0;
  return {rung, all.rmse, errors.noise, signal, all.receivers, all.rel_rmse};
}

std::vector<Scored> all_of(const Score& score, std::size_t receivers) {
  std::vector<Scored> all;
  for (const auto& [rung, errors] : score.errors) all.push_back(scored(rung, errors));
  if (const auto& frames = score.sequence) {
    const auto add = [&](const char* name, const auto& values, double floor) {
      if (const auto mean = mean_defined(values))
        all.push_back({name, *mean, floor / std::numbers::sqrt2, 1.0, receivers, mean});
    };
    add("frames", frames->rel_rmse, frames->floor());
    add("flicker", frames->flicker, frames->flicker_floor());
  }
  return all;
}

ErrorComparison compare(const Scored& base, const Scored& next, bool same_scene, const Thresholds& thresholds) {
  using Verdict = ErrorComparison::Verdict;
  ErrorComparison result{Verdict::same, base.rung, base.relative, next.relative, 1.0, false, ""};
  for (const auto& [whose, side] : {std::pair("base", &base), {"new", &next}})
    if (const std::string fault = fault_of(*side); !fault.empty()) {
      result.verdict = Verdict::unknown;
      result.why = fmt::format("the error of {} against {} {}", whose, side->rung, fault);
      return result;
    }
  const bool same_reference = same_scene && base.noise == next.noise && base.receivers == next.receivers;
  const double noise = same_reference ? 8.0 * base.noise / std::sqrt(double(std::max<std::size_t>(base.receivers, 1)))
                                      : std::max(base.noise, next.noise);
  const double allowed = noise + rounding(std::max(base.error, next.error), std::max(base.signal, next.signal));
  const double from = base.above_noise(), to = next.above_noise();
  result.factor = from > 0.0 ? to / from : to > 0.0 ? INFINITY : 1.0;
  if (to - from > allowed) result.verdict = Verdict::worse;
  if (from - to > allowed) result.verdict = Verdict::better;
  result.regressed = result.verdict == Verdict::worse && to > from * (1.0 + thresholds.error);
  return result;
}

/// Does the first tell more than the second?
bool tells_more(const ErrorComparison& a, const ErrorComparison& b) {
  const auto weight = [](const ErrorComparison& c) {
    using Verdict = ErrorComparison::Verdict;
    const bool changed = c.verdict == Verdict::worse || c.verdict == Verdict::better;
    return std::tuple(c.regressed, c.verdict == Verdict::unknown, c.verdict == Verdict::worse, changed,
                      c.rung == "truth", std::abs(std::log(c.factor)));
  };
  return weight(a) > weight(b);
}

/// Of separate runs, which nobody measures on until they are certain: within the threshold, and 95 % of what the ratio
/// may be within twice that.
bool surely_near(const TimeComparison& change, double most) {
  return change.ratio <= most && change.ratio >= 1.0 / most && change.interval.within(1.0 / (most * most), most * most);
}

}  // namespace

bool paired(const Timing& base, const Timing& next) {
  return !base.launch.empty() && base.launch == next.launch && base.launch.size() == base.frame_ms.size() &&
         next.launch.size() == next.frame_ms.size();
}

std::vector<double> changes_of_launches(const Timing& base, const Timing& next) {
  std::vector<double> changes, of_one;
  for (std::size_t k = 0; k < base.launch.size(); ++k) {
    of_one.push_back(std::log(next.frame_ms[k] / base.frame_ms[k]));
    if (k + 1 < base.launch.size() && base.launch[k + 1] == base.launch[k]) continue;
    changes.push_back(median(of_one));
    of_one.clear();
  }
  return changes;
}

TimeComparison measure_change(const Timing& base, const Timing& next, int looks) {
  TimeComparison change;
  if (!base.timed() && !next.timed()) return change;
  change.verdict = TimeComparison::Verdict::unknown;
  change.why = fault_of("base", base.frame_ms);
  if (change.why.empty()) change.why = fault_of("new", next.frame_ms);
  if (!change.why.empty()) return change;
  change.base_ms = base.median_frame_ms(), change.next_ms = next.median_frame_ms();
  if (looks > 0 && paired(base, next)) {
    change.paired = true;
    const std::vector<double> changes = changes_of_launches(base, next);
    const Interval interval = student_interval(changes, level);
    double sum = 0.0;
    for (const double c : changes) sum += c;
    change.ratio = std::exp(sum / double(changes.size()));
    change.interval = {std::exp(interval.low), std::exp(interval.high)};
    change.probability = std::min(1.0, looks * student_test(changes));
  } else {
    change.ratio = change.next_ms / change.base_ms;
    change.interval = bootstrap_ratio(base.frame_ms, next.frame_ms, level);
    change.probability = mann_whitney(base.frame_ms, next.frame_ms);
    change.identical = base.frame_ms == next.frame_ms;
  }
  return change;
}

void judge(const Thresholds& thresholds, TimeComparison& change) {
  using Verdict = TimeComparison::Verdict;
  if (change.verdict != Verdict::unknown || !change.why.empty()) return;
  const double most = 1.0 + thresholds.slower;
  if (change.probability < false_alarms && !change.interval.contains(1.0)) {
    change.verdict = change.ratio > 1.0 ? Verdict::slower : Verdict::faster;
    change.regressed = change.ratio > most;
  } else if (change.identical ||
             (change.paired ? change.interval.within(1.0 / most, most) : surely_near(change, most))) {
    change.verdict = Verdict::same;
  } else if (change.paired) {
    change.why = "not certain within its budget; give more of it (--budget)";
  } else {
    change.why = change.interval.contains(1.0)
                     ? "samples scatter too much to tell; take more (--repetitions), or compare --ab"
                     : "it looks changed, but so few samples do not prove it; take more (--repetitions)";
  }
}

ErrorComparison compare_errors(const std::vector<const Row*>& base, const std::vector<const Row*>& next,
                               const Thresholds& thresholds) {
  ErrorComparison worst;
  for (const Row* b : base)
    for (const Row* n : next)
      if (const ErrorComparison one = compare_errors(*b, *n, thresholds); worst.rung.empty() || tells_more(one, worst))
        worst = one;
  return worst;
}

ErrorComparison compare_errors(const Row& base, const Row& next, const Thresholds& thresholds) {
  const std::vector<Scored> before = all_of(base.score, base.id.receivers), now = all_of(next.score, next.id.receivers);
  const bool same_scene = base.facts.scene_key == next.facts.scene_key;
  ErrorComparison worst;
  for (const Scored& b : before) {
    const auto at = std::find_if(now.begin(), now.end(), [&](const Scored& n) { return n.rung == b.rung; });
    ErrorComparison one{ErrorComparison::Verdict::unknown,
                        b.rung,
                        b.relative,
                        {},
                        1.0,
                        false,
                        fmt::format("new has no error against {}", b.rung)};
    if (at != now.end()) one = compare(b, *at, same_scene, thresholds);
    if (worst.rung.empty() || tells_more(one, worst)) worst = one;
  }
  return worst;
}

}  // namespace penumbra
