#include "harness/measure/suite.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <thread>

#include "scenes/assets.h"
#include "scenes/names.h"
#include "scenes/toml_reader.h"

namespace penumbra {

std::string Variant::label() const {
  std::string text = entry->name + "/" + to_string(entry->backend);
  for (const Parameter& p : entry->parameters)
    if (const ParameterValue& value = parameters.all().at(p.name); value != p.fallback)
      text += "/" + p.name + ":" + to_string(value);
  return threads == 0 ? text : text + "/threads:" + std::to_string(threads);
}

Variant variant_of(std::shared_ptr<const External> external) {
  const Entry* entry = &external->entry;
  return {entry, {}, 0, std::move(external)};
}

namespace {

/// A value or a list of values, as a list.
std::vector<ParameterValue> values_of(TomlReader& at, const std::string& key) {
  const toml::node* node = at.node(key);
  std::vector<ParameterValue> values;
  const auto add = [&](const toml::node& n) {
    if (n.is_integer()) values.emplace_back(int(*n.value<int64_t>()));
    else if (n.is_floating_point()) values.emplace_back(*n.value<double>());
    else if (n.is_string()) values.emplace_back(*n.value<std::string>());
    else at.fail(key, "must be a number, a string, or a list of these");
  };
  if (const toml::array* list = node->as_array())
    for (const toml::node& item : *list) add(item);
  else add(*node);
  if (values.empty()) at.fail(key, "must not be empty");
  return values;
}

std::vector<std::string> texts_of(TomlReader& at, const std::string& key) {
  std::vector<std::string> texts;
  if (!at.has(key)) return texts;
  for (const auto& value : values_of(at, key)) {
    if (!std::holds_alternative<std::string>(value)) at.fail(key, "must hold strings");
    texts.push_back(std::get<std::string>(value));
  }
  return texts;
}

/// A scene's file starts at the suite's folder, as a scene names its mesh; what is no file there is a shipped name.
std::string beside(const std::string& suite_file, const std::string& name) {
  const std::filesystem::path path = std::filesystem::path(suite_file).parent_path() / name;
  const bool is_path = name.ends_with(".toml") || name.find('/') != std::string::npos;
  return is_path || std::filesystem::is_regular_file(path) ? path.string() : name;
}

std::vector<int> integers_of(TomlReader& at, const std::string& key, int low, int high) {
  std::vector<int> numbers;
  if (!at.has(key)) return numbers;
  for (const auto& value : values_of(at, key)) {
    if (!std::holds_alternative<int>(value) || std::get<int>(value) < low || std::get<int>(value) > high)
      at.fail(key, fmt::format("must hold integers in [{}, {}]", low, high));
    numbers.push_back(std::get<int>(value));
  }
  return numbers;
}

/// Every count with every objective.
std::vector<SphereChoice> sphere_choices(TomlReader& at) {
  std::vector<std::optional<int>> counts;
  for (const int count : integers_of(at, "spheres", 1, 4096)) counts.emplace_back(count);
  if (counts.empty()) counts.emplace_back();
  std::vector<std::optional<Objective>> objectives;
  for (const std::string& name : texts_of(at, "objective")) {
    try {
      objectives.emplace_back(parse_objective(name));
    } catch (const Error& e) {
      at.fail("objective", e.what());
    }
  }
  if (objectives.empty()) objectives.emplace_back();
  std::vector<SphereChoice> choices;
  for (const auto& count : counts)
    for (const auto& objective : objectives) choices.push_back({count, objective});
  return choices;
}

/// Every combination of the axes.
std::vector<Parameters> combinations(TomlReader* at) {
  std::vector<Parameters> all(1);
  if (!at) return all;
  for (const auto& [key, node] : at->raw()) {
    std::vector<Parameters> grown;
    for (const Parameters& base : all)
      for (const ParameterValue& value : values_of(*at, std::string(key.str()))) {
        grown.push_back(base);
        grown.back().set(std::string(key.str()), value);
      }
    all = std::move(grown);
  }
  return all;
}

/// `baseline`: one technique with one set of parameters.
Variant read_baseline(TomlReader at, const Registry& registry) {
  const std::string name = at.required("name", at.text("name"), "a technique's name");
  const std::optional<std::string> backend = at.text("backend");
  auto table = at.table("parameters");
  const std::vector<Parameters> given = combinations(table ? &*table : nullptr);
  if (given.size() != 1) at.fail("parameters", "must have one value each: a baseline is one image");
  at.finish();
  try {
    Variant variant{&registry.find(name, backend.value_or(to_string(registry.usual_backends(name).back()))),
                    {},
                    std::max(1, int(std::thread::hardware_concurrency()))};
    variant.parameters = given[0].resolve(variant.entry->parameters, variant.entry->title());
    return variant;
  } catch (const Error& e) {
    throw Error("{}: {}", at.where(table ? "parameters" : "name"), e.what());
  }
}

PublishedTime read_published_time(TomlReader& at) {
  PublishedTime line;
  line.table = at.required("table", at.text("table"), "column `table` of the published file");
  line.subject = at.required("subject", at.text("subject"), "column `subject` of the published file");
  line.variant = at.required("variant", at.text("variant"), "column `variant` of the published file");
  line.row = at.required("row", at.text("row"), "a regular expression for names of rows");
  line.stages = texts_of(at, "stages");
  at.finish();
  return line;
}

/// Scalar code runs on one thread; beside a device, the host's threads only help to prepare.
std::vector<int> counts_for(Backend backend, const std::vector<int>& threads) {
  if (backend == Backend::scalar) return {1};
  return backend == Backend::cuda ? std::vector<int>{threads.back()} : threads;
}

/// Throws Error if the suite has it already; `table`: what lists it.
void add_variant(Variant variant, const char* table, Suite& suite) {
  const auto same = [&, label = variant.label()](const Variant& other) { return other.label() == label; };
  if (std::any_of(suite.variants.begin(), suite.variants.end(), same))
    throw Error("{} lists {} a second time; allowed is every combination once", table, variant.label());
  suite.variants.push_back(std::move(variant));
}

void add_variants(TomlReader& at, const Registry& registry, const std::vector<int>& threads, Suite& suite) {
  const std::string name = at.required("name", at.text("name"), "a technique's name");
  std::vector<std::string> backends = texts_of(at, "backend");
  const std::vector<int> own = integers_of(at, "threads", 1, 1024);
  auto table = at.table("parameters");
  try {
    if (backends.empty())
      for (const Backend usual : registry.usual_backends(name)) backends.push_back(to_string(usual));
    for (const std::string& backend : backends)
      for (const Parameters& given : combinations(table ? &*table : nullptr)) {
        Variant variant{&registry.find(name, backend), {}, 1};
        variant.parameters = given.resolve(variant.entry->parameters, variant.entry->title());
        for (const int count : counts_for(variant.entry->backend, own.empty() ? threads : own)) {
          variant.threads = count;
          add_variant(variant, "[[technique]]", suite);
        }
      }
  } catch (const Error& e) {
    throw Error("{}: {}", at.where(table ? "parameters" : "name"), e.what());
  }
  at.finish();
}

/// `[[external]]`: its command runs in the suite's folder, as the suite's paths start there.
void add_external(TomlReader& at, Suite& suite) {
  const std::string name = at.required("name", at.text("name"), "a name for its rows");
  if (const std::string fault = name_fault(name); !fault.empty()) at.fail("name", fault);
  const std::string command =
      at.required("command", at.text("command"), "what makes the image, with {scene} and {out}");
  if (command.find("{out}") == std::string::npos)
    at.fail("command", "must say where {out}, the image to write, belongs, as in \"./mine {scene} {out}\"");
  const double timeout_s = at.number("timeout_s", 0.1, 1e6).value_or(600.0);
  const bool reads_spheres = at.boolean("reads_spheres").value_or(true);
  at.finish();
  const std::filesystem::path folder = std::filesystem::absolute(at.file()).parent_path();
  try {
    add_variant(variant_of(make_external(name, command, folder.string(), timeout_s, reads_spheres)), "[[external]]",
                suite);
  } catch (const Error& e) {
    throw Error("{}: {}", at.where("name"), e.what());
  }
}

}  // namespace

Suite load_suite(const std::string& name_or_path, const Registry& registry, int threads,
                 const std::vector<std::string>& scenes) {
  TomlReader file = TomlReader::open(shipped_file(name_or_path, "suites"));
  Suite suite;
  suite.name = read_name(file);
  for (const std::string& name : texts_of(file, "scenes")) suite.scenes.push_back(beside(file.file(), name));
  suite.scenes_where = file.where("scenes") + ": key 'scenes'";
  if (!scenes.empty()) suite.scenes = scenes, suite.scenes_where = "--scene";
  if (suite.scenes.empty()) throw Error("{}: key 'scenes' is missing: a list of scene names or paths", file.where());
  suite.spheres = sphere_choices(file);
  suite.spheres_where = file.where(file.has("spheres") ? "spheres" : file.has("objective") ? "objective" : "scenes");
  suite.repetitions = file.integer("repetitions", 1, 1000).value_or(9);
  suite.truth_noise = file.number("truth_noise", 1e-5, 1.0).value_or(0.002);
  suite.sequence = file.boolean("sequence").value_or(false);
  suite.attribution = file.boolean("attribution").value_or(false);
  suite.published = file.text("published").value_or("");
  for (TomlReader& line : file.tables("published_time")) suite.published_times.push_back(read_published_time(line));
  if (!suite.published_times.empty() && suite.published.empty())
    throw Error("{}: [[published_time]] needs the key 'published'", file.where());
  if (auto baseline = file.table("baseline")) suite.baseline = read_baseline(*baseline, registry);
  std::vector<int> counts = integers_of(file, "threads", 1, 1024);
  if (threads > 0) counts = {threads};
  if (counts.empty()) counts = {std::max(1, int(std::thread::hardware_concurrency()))};
  for (TomlReader& technique : file.tables("technique")) add_variants(technique, registry, counts, suite);
  for (TomlReader& external : file.tables("external")) add_external(external, suite);
  if (suite.variants.empty()) throw Error("{}: no [[technique]] is listed, and no [[external]]", file.where());
  file.finish();
  return suite;
}

}  // namespace penumbra
