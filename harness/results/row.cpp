#include "harness/results/row.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "harness/results/statistics.h"

namespace penumbra {

std::string RowIdentity::variant() const {
  std::string text = technique + "/" + backend;
  for (const auto& [key, value] : parameters.all()) text += "/" + key + ":" + to_string(value);
  return threads == 0 ? text : text + "/threads:" + std::to_string(threads);
}

std::string RowIdentity::name() const {
  std::string text = scene + "/spheres:" + std::to_string(spheres);
  if (!objective.empty()) text += "/objective:" + objective;
  return text + "/" + variant();
}

double Timing::median_frame_ms() const {
  return timed() ? median(frame_ms) : std::numeric_limits<double>::quiet_NaN();
}

double Timing::frame_spread_ms() const {
  return spread(frame_ms);
}

double Timing::stages_ms(const std::vector<std::string>& names) const {
  double sum = 0.0;
  for (const std::string& stage : names) {
    const auto at = std::find_if(stages.begin(), stages.end(), [&](const StageSamples& s) { return s.name == stage; });
    if (at == stages.end()) return std::numeric_limits<double>::quiet_NaN();
    sum += median(at->ms);
  }
  return sum;
}

double RungErrors::floor() const {
  return std::numbers::sqrt2 * rel_noise.value_or(0.0);
}

bool RungErrors::tie() const {
  const auto& error = report.all.rel_rmse;
  return error && *error < floor();
}

double SequenceErrors::floor() const {
  return std::numbers::sqrt2 * rel_noise.value_or(0.0);
}

double SequenceErrors::flicker_floor() const {
  return std::numbers::sqrt2 * floor();
}

std::optional<double> Score::truth_error() const {
  const auto at = errors.find("truth");
  return at == errors.end() ? std::nullopt : at->second.report.all.rel_rmse;
}

}  // namespace penumbra
