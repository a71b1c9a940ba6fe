// penumbra help: formats of files, techniques, commands.
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>

#include "harness/catalogue/catalogue.h"
#include "harness/commands/commands.h"
#include "harness/commands/describe.h"
#include "harness/commands/help_format.h"
#include "harness/commands/templates.h"
#include "harness/report/screen.h"
#include "scenes/error.h"
#include "scenes/nearest_name.h"

namespace penumbra {
namespace {

std::string help_of(const std::vector<std::string>& words, CLI::App& app) {
  if (words.empty()) return first_screen(app);
  const std::string& topic = words[0];
  if (topic == "technique") {
    if (words.size() < 2) throw Error("help technique: which one? (`penumbra list`)");
    return describe_technique(words[1], make_registry(), screen_width());
  }
  if (topic == "scene") return scene_template();
  if (topic == "suite") return suite_template();
  std::vector<std::string> topics = {"scene", "suite", "technique"};
  for (CLI::App* command : app.get_subcommands({})) {
    if (command->get_name() == topic) return command->help();
    topics.push_back(command->get_name());
  }
  throw Error("help: there is nothing on '{}'{}; there is help on: {}", topic, did_you_mean(topic, topics),
              fmt::join(topics, ", "));
}

}  // namespace

void add_help(CLI::App& app, int&) {
  auto* command = app.add_subcommand("help", "Help on a command; the formats of scenes and suites; all of a technique");
  static std::vector<std::string> words;
  command->add_option("topic", words, "scene, suite, technique NAME, or a command");
  command->callback([&app] { std::fputs(help_of(words, app).c_str(), stdout); });
}

}  // namespace penumbra
