#include "harness/results/row_json.h"

#include <cmath>

#include "harness/results/statistics.h"

namespace penumbra {
namespace {

using nlohmann::json;

/// JSON has no number for what is undefined or infinite.
json number(const std::optional<double>& value) {
  return value && std::isfinite(*value) ? json(*value) : json(nullptr);
}

/// Times that are not known are negative.
json milliseconds(double ms) {
  return ms < 0.0 ? json(nullptr) : json(ms);
}

/// null of no samples.
json median_json(const std::vector<double>& samples) {
  return samples.empty() ? json(nullptr) : json(median(samples));
}

json numbers(const std::vector<std::optional<double>>& values) {
  json out = json::array();
  for (const auto& value : values) out.push_back(number(value));
  return out;
}

json errors_json(const Errors& e) {
  const auto of_some = [&](double value) { return e.receivers > 0 ? json(value) : json(nullptr); };
  return {{"receivers", e.receivers}, {"rmse", of_some(e.rmse)}, {"rel_rmse", number(e.rel_rmse)},
          {"psnr", number(e.psnr)},   {"max", of_some(e.max)},   {"mean_signed", of_some(e.mean_signed)},
          {"negative", e.negative},   {"ssim", number(e.ssim)},  {"flip", number(e.flip)}};
}

json bytes_json(const Facts::Bytes& bytes) {
  return {{"tables", bytes.tables}, {"per_scene", bytes.per_scene}, {"per_frame", bytes.per_frame}};
}

void put_identity(const RowIdentity& id, json& out) {
  out["name"] = id.name();
  out["scene"] = id.scene;
  out["spheres"] = id.spheres;
  out["reads_spheres"] = id.reads_spheres;
  out["objective"] = id.objective;
  out["receivers"] = id.receivers;
  out["technique"] = id.technique;
  out["backend"] = id.backend;
  out["parameters"] = to_json(id.parameters);
  out["defaults"] = to_json(id.defaults);
  out["threads"] = id.threads;
}

void put_timing(const Timing& t, json& out) {
  out["repetitions"] = t.frame_ms.size();
  out["iterations"] = t.iterations;
  out["frame_ms"] = median_json(t.frame_ms);
  out["prepare_ms"] = milliseconds(t.prepare_ms);
  out["update_ms"] = median_json(t.update_ms);
  out["shade_ms"] = median_json(t.shade_ms);
  out["frame_spread_ms"] = t.timed() ? json(t.frame_spread_ms()) : json(nullptr);
  out["samples"] = {{"update_ms", t.update_ms}, {"shade_ms", t.shade_ms}, {"frame_ms", t.frame_ms}};
  if (!t.cpu_ms.empty()) out["samples"]["cpu_ms"] = t.cpu_ms;
  out["stages"] = json::array();
  for (const StageSamples& stage : t.stages)
    out["stages"].push_back({{"name", stage.name}, {"ms", median(stage.ms)}, {"samples", stage.ms}});
  out["view_ms"] = milliseconds(t.view_ms);
  out["command_ms"] = milliseconds(t.command_ms);
}

json sequence_json(const SequenceErrors& s) {
  return {{"rel_rmse", numbers(s.rel_rmse)},
          {"flicker", numbers(s.flicker)},
          {"coverage", s.coverage},
          {"rel_noise", number(s.rel_noise)},
          {"carry_ms", s.carry_ms}};
}

void put_score(const Score& score, json& out) {
  out["parity_rel_rmse"] = score.parity < 0 ? json(nullptr) : json(score.parity);
  out["geometry_rel_rmse"] = number(score.geometry);
  if (score.sequence) out["sequence"] = sequence_json(*score.sequence);
  for (const StepError& step : score.steps)
    out["steps"].push_back({{"name", step.name}, {"rel_rmse", step.rel_rmse}, {"share", step.share}});
  out["errors"] = json::object();
  for (const auto& [rung, errors] : score.errors) {
    json& at = out["errors"][rung] = errors_json(errors.report.all);
    at["noise"] = errors.noise;
    at["rel_noise"] = number(errors.rel_noise);
    at["tie"] = errors.tie();
    for (int k = 0; k < 3; ++k) at["regions"][region_names[k]] = errors_json(errors.report.region[k]);
  }
}

void put_facts(const Facts& facts, bool known_bytes, json& out) {
  out["scene_key"] = facts.scene_key;
  out["key"] = facts.key;
  out["instruction_set"] = facts.instruction_set;
  out["bytes"] = known_bytes ? json(facts.bytes.total()) : json(nullptr);
  out["footprint"] = bytes_json(facts.bytes);
  out["counters"] = facts.counters;
  if (!facts.image.empty()) out["image"] = facts.image;
}

}  // namespace

json to_json(const Values& values) {
  json out = json::object();
  for (const auto& [name, value] : values) std::visit([&, &key = name](const auto& v) { out[key] = v; }, value);
  return out;
}

json to_json(const Row& row) {
  json out = json::object();
  put_identity(row.id, out);
  put_timing(row.timing, out);
  put_score(row.score, out);
  put_facts(row.facts, !row.id.external(), out);
  out["status"] = row.status;
  return out;
}

}  // namespace penumbra
