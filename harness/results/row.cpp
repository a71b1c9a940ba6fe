#include "harness/results/row.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "harness/results/statistics.h"
#include "scenes/storage/content_key.h"

namespace penumbra {

namespace {

std::string scene_text(const RowIdentity& id) {
  std::string text = id.scene + "/spheres:" + std::to_string(id.spheres);
  return id.objective.empty() ? text : text + "/objective:" + id.objective;
}

bool is_default(const RowIdentity& id, const std::string& parameter, const Value& value) {
  const auto at = id.defaults.find(parameter);
  return at != id.defaults.end() && at->second == value;
}

std::string variant_text(const RowIdentity& id, bool with_defaults) {
  std::string text = id.technique + "/" + id.backend;
  for (const auto& [key, value] : id.parameters)
    if (with_defaults || !is_default(id, key, value)) text += "/" + key + ":" + to_string(value);
  return id.threads == 0 ? text : text + "/threads:" + std::to_string(id.threads);
}

/// As many whole letters as fit, and a hash of all behind them.
std::string shortened(const std::string& text, std::size_t longest) {
  if (text.size() <= longest) return text;
  ContentHash hash;
  hash.add(text);
  const std::string tail = "~" + hash.digest().substr(0, 12);
  std::size_t size = longest - tail.size();
  while (size > 0 && (static_cast<unsigned char>(text[size]) & 0xC0) == 0x80) --size;
  return text.substr(0, size) + tail;
}

}  // namespace

std::string RowIdentity::variant() const {
  return variant_text(*this, false);
}

std::string RowIdentity::name() const {
  return shortened(scene_text(*this) + "/" + variant(), longest_name);
}

std::string RowIdentity::full_name() const {
  return scene_text(*this) + "/" + variant_text(*this, true);
}

bool is_in(const Pattern& pattern, const RowIdentity& id) {
  return pattern.is_in(id.name()) || pattern.is_in(id.full_name());
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
