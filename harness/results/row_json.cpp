#include "harness/results/row_json.h"

#include <cmath>
#include <limits>

#include "harness/results/statistics.h"

namespace penumbra {
namespace {

using nlohmann::json;

/// JSON has no number for what is undefined or infinite.
json number(const std::optional<double>& value) {
  return value && std::isfinite(*value) ? json(*value) : json(nullptr);
}

std::optional<double> number_from(const json& in) {
  return in.is_null() ? std::nullopt : std::optional(in.get<double>());
}

/// Times that are not known are negative.
json milliseconds(double ms) {
  return ms < 0.0 ? json(nullptr) : json(ms);
}

double milliseconds_from(const json& in) {
  return in.is_null() ? -1.0 : in.get<double>();
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

std::vector<std::optional<double>> numbers_from(const json& in) {
  std::vector<std::optional<double>> values;
  for (const json& value : in) values.push_back(number_from(value));
  return values;
}

json errors_json(const Errors& e) {
  const auto of_some = [&](double value) { return e.receivers > 0 ? json(value) : json(nullptr); };
  return {{"receivers", e.receivers}, {"rmse", of_some(e.rmse)}, {"rel_rmse", number(e.rel_rmse)},
          {"psnr", number(e.psnr)},   {"max", of_some(e.max)},   {"mean_signed", of_some(e.mean_signed)},
          {"negative", e.negative},   {"ssim", number(e.ssim)},  {"flip", number(e.flip)}};
}

Errors errors_from(const json& in) {
  Errors e;
  e.receivers = in.at("receivers"), e.negative = in.at("negative");
  e.rmse = number_from(in.at("rmse")).value_or(0.0), e.max = number_from(in.at("max")).value_or(0.0);
  e.mean_signed = number_from(in.at("mean_signed")).value_or(0.0);
  e.rel_rmse = number_from(in.at("rel_rmse")), e.psnr = number_from(in.at("psnr"));
  if (!e.psnr && e.rel_rmse && *e.rel_rmse == 0.0) e.psnr = std::numeric_limits<double>::infinity();
  e.ssim = number_from(in.at("ssim")), e.flip = number_from(in.at("flip"));
  return e;
}

json parameters_json(const Parameters& parameters) {
  json out = json::object();
  for (const auto& [name, value] : parameters.all())
    std::visit([&, &key = name](const auto& v) { out[key] = v; }, value);
  return out;
}

Parameters parameters_from(const json& in) {
  Parameters out;
  for (const auto& [name, value] : in.items()) {
    if (value.is_number_integer()) out.set(name, value.get<int>());
    else if (value.is_number()) out.set(name, value.get<double>());
    else out.set(name, value.get<std::string>());
  }
  return out;
}

json bytes_json(const Facts::Bytes& bytes) {
  return {{"tables", bytes.tables}, {"per_scene", bytes.per_scene}, {"per_frame", bytes.per_frame}};
}

void put_identity(const RowIdentity& id, json& out) {
  out["name"] = out["run_name"] = id.name();
  out["scene"] = id.scene;
  out["spheres"] = id.spheres;
  out["reads_spheres"] = id.reads_spheres;
  out["objective"] = id.objective;
  out["receivers"] = id.receivers;
  out["technique"] = id.technique;
  out["backend"] = id.backend;
  out["parameters"] = parameters_json(id.parameters);
  out["defaults"] = parameters_json(id.defaults);
  out["threads"] = id.threads;
}

RowIdentity identity_from(const json& in) {
  RowIdentity id;
  id.scene = in.at("scene"), id.spheres = in.at("spheres"), id.receivers = in.at("receivers");
  id.reads_spheres = in.at("reads_spheres"), id.objective = in.at("objective");
  id.technique = in.at("technique"), id.backend = in.at("backend");
  id.parameters = parameters_from(in.at("parameters")), id.defaults = parameters_from(in.at("defaults"));
  id.threads = in.at("threads");
  return id;
}

void put_timing(const Timing& t, json& out) {
  out["run_type"] = "iteration";
  out["repetitions"] = t.frame_ms.size();
  out["repetition_index"] = 0;
  out["iterations"] = t.iterations;
  out["real_time"] = out["cpu_time"] = out["frame_ms"] = median_json(t.frame_ms);
  out["time_unit"] = "ms";
  out["prepare_ms"] = milliseconds(t.prepare_ms);
  out["update_ms"] = median_json(t.update_ms);
  out["shade_ms"] = median_json(t.shade_ms);
  out["frame_spread_ms"] = t.timed() ? json(t.frame_spread_ms()) : json(nullptr);
  out["samples"] = {{"update_ms", t.update_ms}, {"shade_ms", t.shade_ms}, {"frame_ms", t.frame_ms}};
  out["stages"] = json::array();
  for (const StageSamples& stage : t.stages)
    out["stages"].push_back({{"name", stage.name}, {"ms", median(stage.ms)}, {"samples", stage.ms}});
  out["view_ms"] = milliseconds(t.view_ms);
  out["command_ms"] = milliseconds(t.command_ms);
}

Timing timing_from(const json& in) {
  Timing t;
  t.prepare_ms = milliseconds_from(in.at("prepare_ms")), t.iterations = in.at("iterations");
  const json& samples = in.at("samples");
  t.update_ms = samples.at("update_ms").get<std::vector<double>>();
  t.shade_ms = samples.at("shade_ms").get<std::vector<double>>();
  t.frame_ms = samples.at("frame_ms").get<std::vector<double>>();
  for (const json& stage : in.at("stages"))
    t.stages.push_back({stage.at("name"), stage.at("samples").get<std::vector<double>>()});
  t.view_ms = milliseconds_from(in.at("view_ms"));
  t.command_ms = milliseconds_from(in.value("command_ms", json(nullptr)));
  return t;
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

Score score_from(const json& in) {
  Score score;
  score.parity = in.at("parity_rel_rmse").is_null() ? -1.0 : double(in.at("parity_rel_rmse"));
  score.geometry = number_from(in.at("geometry_rel_rmse"));
  if (in.contains("sequence")) {
    const json& at = in.at("sequence");
    score.sequence = {numbers_from(at.at("rel_rmse")), numbers_from(at.at("flicker")), at.at("coverage"),
                      number_from(at.at("rel_noise")), at.at("carry_ms")};
  }
  if (in.contains("steps"))
    for (const json& at : in.at("steps")) score.steps.push_back({at.at("name"), at.at("rel_rmse"), at.at("share")});
  for (const auto& [rung, at] : in.at("errors").items()) {
    RungErrors& errors = score.errors[rung];
    errors.report.all = errors_from(at);
    errors.noise = at.at("noise"), errors.rel_noise = number_from(at.at("rel_noise"));
    for (int k = 0; k < 3; ++k) errors.report.region[k] = errors_from(at.at("regions").at(region_names[k]));
  }
  return score;
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

Facts facts_from(const json& in) {
  Facts facts;
  facts.scene_key = in.at("scene_key"), facts.key = in.at("key");
  facts.instruction_set = in.at("instruction_set");
  const json& bytes = in.at("footprint");
  facts.bytes = {bytes.at("tables"), bytes.at("per_scene"), bytes.at("per_frame")};
  facts.counters = in.at("counters").get<std::map<std::string, std::size_t>>();
  facts.image = in.value("image", "");
  return facts;
}

}  // namespace

json to_json(const Row& row) {
  json out = json::object();
  put_identity(row.id, out);
  put_timing(row.timing, out);
  put_score(row.score, out);
  put_facts(row.facts, !row.id.external(), out);
  out["status"] = row.status;
  if (!row.ok()) out["error_occurred"] = true, out["error_message"] = row.status;
  return out;
}

Row row_from_json(const json& in) {
  return {identity_from(in), timing_from(in), score_from(in), facts_from(in), in.at("status")};
}

}  // namespace penumbra
