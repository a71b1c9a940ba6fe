// penumbra list: techniques, scenes and suites of this build.
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "harness/catalogue/catalogue.h"
#include "harness/commands/commands.h"
#include "harness/commands/describe.h"
#include "harness/commands/input_kind.h"
#include "harness/report/screen.h"
#include "scenes/assets.h"
#include "scenes/error.h"
#include "scenes/nearest_name.h"
#include "techniques/registry.h"

namespace penumbra {
namespace {

void list_as_json(const Registry& registry) {
  nlohmann::json out = {{"techniques", nlohmann::json::array()},
                        {"scenes", shipped_names("library")},
                        {"suites", shipped_names("suites")}};
  for (const auto& [backend, state] : registry.states()) out[to_string(backend)] = state.status;
  for (const Entry& e : registry.entries()) {
    nlohmann::json entry = {{"name", e.name},
                            {"backend", to_string(e.backend)},
                            {"summary", e.summary},
                            {"citation", e.citation},
                            {"available", e.unavailable.empty()},
                            {"reason", e.unavailable},
                            {"lights", {{"environment", e.lights.environment}, {"area", e.lights.area}}}};
    for (const Parameter& p : e.parameters)
      entry["parameters"].push_back({{"name", p.name},
                                     {"unit", p.unit},
                                     {"default", to_string(p.fallback)},
                                     {"allowed", p.range()},
                                     {"meaning", p.meaning}});
    out["techniques"].push_back(entry);
  }
  fmt::print("{}\n", out.dump(1));
}

std::string short_list(const Registry& registry, int width) {
  std::string text = "techniques (penumbra list NAME: parameters, citation)\n";
  for (const std::string& name : technique_names(registry)) {
    const Entry& entry = registry.find(name, registry.usual_backends(name).back());
    text += fmt::format("  {:19} {:20} {}\n", name, lights_of(entry.lights), backends_of(name, registry));
  }
  text += "\n" + labelled("scenes", fmt::format("{}", fmt::join(shipped_names("library"), ", ")), 10, width);
  text += "\n" + labelled("suites", fmt::format("{}", fmt::join(shipped_names("suites"), ", ")), 10, width);
  text += "\n";
  for (const auto& [backend, state] : registry.states())  // scripts look for these lines
    text += wrapped(to_string(backend) + ": " + state.status, width, 6) + "\n";
  return text;
}

/// All that is called so: a technique, a scene and a suite may share a name.
std::string whole_list(const std::string& name, const Registry& registry, int width) {
  std::string text;
  const auto add = [&](const std::string& more) { text += (text.empty() ? "" : "\n") + more; };
  if (is_called(name, InputKind::technique, registry)) add(describe_technique(name, registry, width));
  if (is_called(name, InputKind::scene, registry)) add(describe_scene(name, width));
  if (is_called(name, InputKind::suite, registry)) add(describe_suite(name, registry, width));
  if (!text.empty()) return text;
  std::vector<std::string> names = technique_names(registry);
  for (const char* folder : {"library", "suites"})
    for (const std::string& shipped : shipped_names(folder)) names.push_back(shipped);
  if (const std::string what = what_it_is(name, registry); !what.empty())
    throw Error("'{}' is no technique, scene or suite but {}", name, what);
  throw Error("'{}' is no technique, scene or suite{} (`penumbra list`)", name, did_you_mean(name, names));
}

}  // namespace

void add_list(CLI::App& app, int&) {
  auto* command = app.add_subcommand("list", "Techniques, scenes and suites of this build; all of one of them");
  static bool json = false;
  static std::string name;
  command->add_option("name", name, "A technique, scene or suite, or a scene's or suite's file");
  command->add_flag("--json", json, "Techniques, scenes and suites for machines");
  command->callback([] {
    const Registry registry = make_registry();
    if (json) return list_as_json(registry);
    std::fputs(
        (name.empty() ? short_list(registry, screen_width()) : whole_list(name, registry, screen_width())).c_str(),
        stdout);
  });
}

}  // namespace penumbra
