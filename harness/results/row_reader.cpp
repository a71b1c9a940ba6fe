#include "harness/results/row_reader.h"

#include <cmath>
#include <limits>
#include <utility>

#include "harness/results/row_json.h"
#include "scenes/error.h"

namespace penumbra {
namespace {

using simdjson::dom::array;
using simdjson::dom::element;
using simdjson::dom::object;

template <class T>
T as(const element& value, const char* name, const char* what) {
  T out;
  if (value.get(out) != simdjson::SUCCESS) throw Error("its field '{}' is not {}", name, what);
  return out;
}

array array_of(const element& in, const char* name) {
  return as<array>(field(in, name), name, "an array");
}

object object_of(const element& in, const char* name) {
  return as<object>(field(in, name), name, "an object");
}

std::uint64_t count_of(const element& in, const char* name) {
  return as<std::uint64_t>(field(in, name), name, "a whole number");
}

std::int64_t integer_of(const element& in, const char* name) {
  return as<std::int64_t>(field(in, name), name, "a whole number");
}

bool has(const element& in, const char* name) {
  return in.at_key(name).error() == simdjson::SUCCESS;
}

/// null where nothing is known or defined.
std::optional<double> optional_number(const element& value, const char* name) {
  if (value.is_null()) return std::nullopt;
  return as<double>(value, name, "a number or null");
}

std::optional<double> optional_number_of(const element& in, const char* name) {
  return optional_number(field(in, name), name);
}

double milliseconds_of(const element& in, const char* name) {
  return optional_number_of(in, name).value_or(-1.0);
}

std::vector<double> numbers_of(const element& in, const char* name) {
  std::vector<double> values;
  for (const element value : array_of(in, name)) values.push_back(as<double>(value, name, "an array of numbers"));
  return values;
}

std::vector<std::optional<double>> optional_numbers_of(const element& in, const char* name) {
  std::vector<std::optional<double>> values;
  for (const element value : array_of(in, name)) values.push_back(optional_number(value, name));
  return values;
}

Value value_from(const element& value, const char* name) {
  if (std::string_view word; value.get(word) == simdjson::SUCCESS) return std::string(word);
  if (std::int64_t whole = 0; value.get(whole) == simdjson::SUCCESS && std::in_range<int>(whole)) return int(whole);
  return as<double>(value, name, "an object of numbers and words");
}

Values values_of(const element& in, const char* name) {
  Values out;
  for (const auto [key, value] : object_of(in, name)) out.emplace(key, value_from(value, name));
  return out;
}

Errors errors_from(const element& in) {
  Errors e;
  e.receivers = count_of(in, "receivers"), e.negative = count_of(in, "negative");
  e.rmse = optional_number_of(in, "rmse").value_or(e.receivers == 0 ? 0.0 : NAN),
  e.max = optional_number_of(in, "max").value_or(0.0);
  e.mean_signed = optional_number_of(in, "mean_signed").value_or(0.0);
  e.rel_rmse = optional_number_of(in, "rel_rmse"), e.psnr = optional_number_of(in, "psnr");
  if (!e.psnr && e.rel_rmse && *e.rel_rmse == 0.0) e.psnr = std::numeric_limits<double>::infinity();
  e.ssim = optional_number_of(in, "ssim"), e.flip = optional_number_of(in, "flip");
  return e;
}

RowIdentity identity_from(const element& in) {
  RowIdentity id;
  id.scene = text_of(in, "scene"), id.spheres = count_of(in, "spheres"), id.receivers = count_of(in, "receivers");
  id.reads_spheres = as<bool>(field(in, "reads_spheres"), "reads_spheres", "true or false");
  id.objective = text_of(in, "objective");
  id.technique = text_of(in, "technique"), id.backend = text_of(in, "backend");
  id.parameters = values_of(in, "parameters"), id.defaults = values_of(in, "defaults");
  id.threads = int(integer_of(in, "threads"));
  return id;
}

Timing timing_from(const element& in) {
  Timing t;
  t.prepare_ms = milliseconds_of(in, "prepare_ms"), t.iterations = long(integer_of(in, "iterations"));
  if (has(in, "samples")) {
    const element samples = field(in, "samples");
    t.update_ms = numbers_of(samples, "update_ms"), t.shade_ms = numbers_of(samples, "shade_ms");
    t.frame_ms = numbers_of(samples, "frame_ms");
    if (has(samples, "cpu_ms")) t.cpu_ms = numbers_of(samples, "cpu_ms");
  }
  for (const element stage : array_of(in, "stages"))
    t.stages.push_back({text_of(stage, "name"), numbers_of(stage, "samples")});
  t.view_ms = milliseconds_of(in, "view_ms");
  if (has(in, "command_ms")) t.command_ms = milliseconds_of(in, "command_ms");
  return t;
}

SequenceErrors sequence_from(const element& in) {
  return {optional_numbers_of(in, "rel_rmse"), optional_numbers_of(in, "flicker"), numbers_of(in, "coverage"),
          optional_number_of(in, "rel_noise"), number_of(in, "carry_ms")};
}

RungErrors rung_from(const element& in) {
  RungErrors errors;
  errors.report.all = errors_from(in);
  errors.noise = number_of(in, "noise"), errors.rel_noise = optional_number_of(in, "rel_noise");
  const element regions = field(in, "regions");
  for (std::size_t k = 0; k < region_names.size(); ++k)
    errors.report.region[k] = errors_from(field(regions, region_names[k]));
  return errors;
}

Score score_from(const element& in) {
  Score score;
  score.parity = milliseconds_of(in, "parity_rel_rmse");  // -1 of null, like an unknown time
  score.geometry = optional_number_of(in, "geometry_rel_rmse");
  if (has(in, "sequence")) score.sequence = sequence_from(field(in, "sequence"));
  if (has(in, "steps"))
    for (const element at : array_of(in, "steps"))
      score.steps.push_back({text_of(at, "name"), number_of(at, "rel_rmse"), number_of(at, "share")});
  for (const auto [rung, errors] : object_of(in, "errors")) score.errors.emplace(rung, rung_from(errors));
  return score;
}

Facts facts_from(const element& in) {
  Facts facts;
  facts.scene_key = text_of(in, "scene_key"), facts.key = text_of(in, "key");
  facts.instruction_set = text_of(in, "instruction_set");
  const element bytes = field(in, "footprint");
  facts.bytes = {count_of(bytes, "tables"), count_of(bytes, "per_scene"), count_of(bytes, "per_frame")};
  for (const auto [name, value] : object_of(in, "counters"))
    facts.counters.emplace(name, as<std::uint64_t>(value, "counters", "an object of whole numbers"));
  if (has(in, "image")) facts.image = text_of(in, "image");
  return facts;
}

}  // namespace

element field(const element& in, const char* name) {
  element out;
  if (in.at_key(name).get(out) != simdjson::SUCCESS) throw Error("it has no field '{}'", name);
  return out;
}

double number_of(const element& in, const char* name) {
  return as<double>(field(in, name), name, "a number");
}

std::string text_of(const element& in, const char* name) {
  return std::string(as<std::string_view>(field(in, name), name, "a word"));
}

Row row_from_json(const std::string& text) {
  simdjson::dom::parser parser;
  return row_from(parser.parse(text));
}

Row row_from(const element& in) {
  return {identity_from(in), timing_from(in), score_from(in), facts_from(in), text_of(in, "status")};
}

}  // namespace penumbra
