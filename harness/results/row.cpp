#include "harness/results/row.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>

#include "harness/measure/timing.h"
#include "scenes/error.h"

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

}  // namespace

std::string Row::variant() const {
  std::string text = technique + "/" + backend;
  for (const auto& [key, value] : parameters.all()) text += "/" + key + ":" + to_string(value);
  return text + "/threads:" + std::to_string(threads);
}

std::string Row::name() const {
  std::string text = scene + "/spheres:" + std::to_string(spheres);
  if (!objective.empty()) text += "/objective:" + objective;
  return text + "/" + variant();
}

double Row::median_frame_ms() const {
  return median(frame_ms);
}

double Row::stages_ms(const std::vector<std::string>& names) const {
  double sum = 0.0;
  for (const std::string& stage : names) {
    const auto at = std::find_if(stages.begin(), stages.end(), [&](const StageSamples& s) { return s.name == stage; });
    if (at == stages.end()) return std::numeric_limits<double>::quiet_NaN();
    sum += median(at->ms);
  }
  return sum;
}

std::optional<double> Row::truth_error() const {
  const auto at = errors.find("truth");
  return at == errors.end() ? std::nullopt : at->second.report.all.rel_rmse;
}

json to_json(const Row& row) {
  const double frame = median(row.frame_ms);
  json out = {{"name", row.name()},
              {"run_name", row.name()},
              {"run_type", "iteration"},
              {"repetitions", row.frame_ms.size()},
              {"repetition_index", 0},
              {"threads", row.threads},
              {"iterations", row.iterations},
              {"real_time", frame},
              {"cpu_time", frame},
              {"time_unit", "ms"}};
  if (!row.ok()) out["error_occurred"] = true, out["error_message"] = row.status;
  out["status"] = row.status;
  out["scene"] = row.scene;
  out["scene_key"] = row.scene_key;
  out["spheres"] = row.spheres;
  out["objective"] = row.objective;
  out["receivers"] = row.receivers;
  out["technique"] = row.technique;
  out["backend"] = row.backend;
  out["instruction_set"] = row.instruction_set;
  out["parameters"] = parameters_json(row.parameters);
  out["prepare_ms"] = row.prepare_ms;
  out["update_ms"] = median(row.update_ms);
  out["shade_ms"] = median(row.shade_ms);
  out["frame_ms"] = frame;
  out["samples"] = {{"update_ms", row.update_ms}, {"shade_ms", row.shade_ms}, {"frame_ms", row.frame_ms}};
  out["stages"] = json::array();
  for (const StageSamples& stage : row.stages)
    out["stages"].push_back({{"name", stage.name}, {"ms", median(stage.ms)}, {"samples", stage.ms}});
  out["view_ms"] = row.view_ms < 0 ? json(nullptr) : json(row.view_ms);
  out["bytes"] = row.bytes.total();
  out["footprint"] = {
      {"tables", row.bytes.tables}, {"per_scene", row.bytes.per_scene}, {"per_frame", row.bytes.per_frame}};
  out["parity_rel_rmse"] = row.parity < 0 ? json(nullptr) : json(row.parity);
  out["geometry_rel_rmse"] = number(row.geometry);
  if (row.sequence)
    out["sequence"] = {{"rel_rmse", numbers(row.sequence->rel_rmse)},
                       {"flicker", numbers(row.sequence->flicker)},
                       {"coverage", row.sequence->coverage},
                       {"rel_noise", number(row.sequence->rel_noise)},
                       {"carry_ms", row.sequence->carry_ms}};
  out["counters"] = row.counters;
  for (const StepError& step : row.steps)
    out["steps"].push_back({{"name", step.name}, {"rel_rmse", step.rel_rmse}, {"share", step.share}});
  out["errors"] = json::object();
  for (const auto& [rung, errors] : row.errors) {
    json& at = out["errors"][rung] = errors_json(errors.report.all);
    at["noise"] = errors.noise;
    at["rel_noise"] = number(errors.rel_noise);
    for (int k = 0; k < 3; ++k) at["regions"][region_names[k]] = errors_json(errors.report.region[k]);
  }
  return out;
}

Row row_from_json(const json& in) {
  Row row;
  row.status = in.at("status");
  row.scene = in.at("scene"), row.scene_key = in.at("scene_key");
  row.spheres = in.at("spheres"), row.receivers = in.at("receivers");
  row.objective = in.at("objective");
  row.technique = in.at("technique"), row.backend = in.at("backend");
  row.instruction_set = in.at("instruction_set");
  row.parameters = parameters_from(in.at("parameters"));
  row.threads = in.at("threads");
  row.prepare_ms = in.at("prepare_ms");
  row.iterations = in.at("iterations");
  const json& samples = in.at("samples");
  row.update_ms = samples.at("update_ms").get<std::vector<double>>();
  row.shade_ms = samples.at("shade_ms").get<std::vector<double>>();
  row.frame_ms = samples.at("frame_ms").get<std::vector<double>>();
  for (const json& stage : in.at("stages"))
    row.stages.push_back({stage.at("name"), stage.at("samples").get<std::vector<double>>()});
  row.view_ms = in.at("view_ms").is_null() ? -1.0 : double(in.at("view_ms"));
  const json& bytes = in.at("footprint");
  row.bytes = {bytes.at("tables"), bytes.at("per_scene"), bytes.at("per_frame")};
  row.parity = in.at("parity_rel_rmse").is_null() ? -1.0 : double(in.at("parity_rel_rmse"));
  row.geometry = number_from(in.at("geometry_rel_rmse"));
  if (in.contains("sequence")) {
    const json& at = in.at("sequence");
    row.sequence = {numbers_from(at.at("rel_rmse")), numbers_from(at.at("flicker")), at.at("coverage"),
                    number_from(at.at("rel_noise")), at.at("carry_ms")};
  }
  row.counters = in.at("counters").get<std::map<std::string, std::size_t>>();
  if (in.contains("steps"))
    for (const json& at : in.at("steps")) row.steps.push_back({at.at("name"), at.at("rel_rmse"), at.at("share")});
  for (const auto& [rung, at] : in.at("errors").items()) {
    RungErrors& errors = row.errors[rung];
    errors.report.all = errors_from(at);
    errors.noise = at.at("noise"), errors.rel_noise = number_from(at.at("rel_noise"));
    for (int k = 0; k < 3; ++k) errors.report.region[k] = errors_from(at.at("regions").at(region_names[k]));
  }
  return row;
}

void write_atomically(const std::string& path, const std::string& text) {
  const std::string partial = path + ".partial";
  std::ofstream out(partial);
  out << text;
  out.close();
  if (!out) throw Error("{}: cannot be written", path);
  std::filesystem::rename(partial, path);
}

void write_results(const std::string& directory, const json& context, const std::vector<Row>& rows) {
  json out = {{"context", context}, {"benchmarks", json::array()}};
  for (const Row& row : rows) out["benchmarks"].push_back(to_json(row));
  // A row's status may quote a path that is no UTF-8.
  write_atomically(directory + "/results.json", out.dump(1, ' ', false, json::error_handler_t::replace) + "\n");
}

std::vector<Row> read_results(const std::string& directory) {
  const std::string path = directory + "/results.json";
  if (!std::filesystem::exists(path)) return {};
  try {
    std::vector<Row> rows;
    const json file = json::parse(std::ifstream(path));
    for (const json& row : file.at("benchmarks")) rows.push_back(row_from_json(row));
    return rows;
  } catch (const json::exception& e) {
    throw Error("{}: not a results file of this version ({}); move it away or run without --resume", path, e.what());
  }
}

}  // namespace penumbra
