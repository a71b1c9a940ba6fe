#include "harness/commands/mistakes.h"

#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cctype>
#include <sstream>

#include "harness/catalogue/catalogue.h"
#include "harness/commands/input_kind.h"
#include "scenes/error.h"
#include "scenes/nearest_name.h"

namespace penumbra {
namespace {

std::vector<std::string> names_of_commands(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* command : app.get_subcommands({})) names.push_back(command->get_name());
  return names;
}

/// "--out", "-o" of every option.
std::vector<std::string> names_of_options(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::Option* option : app.get_options()) {
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
    for (const std::string& name : option->get_snames()) names.push_back("-" + name);
  }
  return names;
}

/// Of several arguments that a command does not know the first option, else the last word: values follow their options.
std::string unexpected(const std::string& message, const CLI::App& command) {
  std::istringstream words(message.substr(std::min(message.find(": "), message.size() - 2) + 2));
  std::string extra;
  for (std::string word; words >> word;)
    if (!extra.starts_with("-")) extra = word;
  return fmt::format("'{}' was not expected{}", extra,
                     did_you_mean(extra.substr(0, extra.find('=')), names_of_options(command)));
}

}  // namespace

void expect_command(const CLI::App& app, const std::string& first) {
  const std::vector<std::string> commands = names_of_commands(app);
  if (first.starts_with("-") || std::find(commands.begin(), commands.end(), first) != commands.end()) return;
  if (const std::string nearest = nearest_name(first, commands); !nearest.empty())
    throw Error("'{0}' is no command; did you mean `penumbra {1}`? (`penumbra {1} --help`)", first, nearest);
  if (const std::string what = what_it_is(first, make_registry()); !what.empty())
    throw Error("'{}' is no command but {}", first, what);
  throw Error("'{}' is no command; there are: {} (`penumbra --help`)", first, fmt::join(commands, ", "));
}

std::string explained(const CLI::App& app, const CLI::ParseError& error) {
  const std::vector<const CLI::App*> parsed = app.get_subcommands({[](const CLI::App* c) { return c->parsed(); }});
  const CLI::App& command = parsed.empty() ? app : *parsed.front();
  std::string what = error.what();
  if (!what.empty()) what[0] = char(std::tolower(static_cast<unsigned char>(what[0])));
  if (dynamic_cast<const CLI::ExtrasError*>(&error)) what = unexpected(what, command);
  if (parsed.empty()) return what + " (`penumbra --help`)";
  return fmt::format("{0}: {1} (`penumbra {0} --help`)", command.get_name(), what);
}

}  // namespace penumbra
