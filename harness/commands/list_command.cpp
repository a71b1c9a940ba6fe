// penumbra list: techniques, scenes and suites of this build.
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "cuda/register_cuda.h"
#include "harness/commands/commands.h"
#include "scenes/assets.h"
#include "techniques/registry.h"

namespace penumbra {
namespace {

void list_as_json(const Registry& registry) {
  nlohmann::json out = {{"techniques", nlohmann::json::array()},
                        {"cuda", cuda_status()},
                        {"scenes", shipped_names("library")},
                        {"suites", shipped_names("suites")}};
  for (const Entry& e : registry.entries()) {
    nlohmann::json entry = {{"name", e.name},
                            {"backend", e.backend},
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

void list(bool json) {
  const Registry registry = make_registry();
  if (json) return list_as_json(registry);
  fmt::print("techniques\n");
  for (const Entry& e : registry.entries()) {
    fmt::print("  {:32} {}{}\n", e.title(), e.summary, e.unavailable.empty() ? "" : " [" + e.unavailable + "]");
    for (const Parameter& p : e.parameters)
      fmt::print("      {} = {}  ({}) {}{}\n", p.name, to_string(p.fallback), p.range(), p.meaning,
                 p.unit.empty() ? "" : " [" + p.unit + "]");
  }
  fmt::print("cuda: {}\nscenes: {}\nsuites: {}\n", cuda_status(), fmt::join(shipped_names("library"), ", "),
             fmt::join(shipped_names("suites"), ", "));
}

}  // namespace

void add_list(CLI::App& app, int&) {
  auto* command = app.add_subcommand("list", "Techniques, scenes and suites of this build");
  static bool json = false;
  command->add_flag("--json", json, "Machine-readable");
  command->callback([] { list(json); });
}

}  // namespace penumbra
