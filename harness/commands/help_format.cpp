#include "harness/commands/help_format.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>

#include "harness/catalogue/catalogue.h"
#include "harness/measure/machine.h"
#include "harness/report/screen.h"

namespace penumbra {
namespace {

/// Where to begin: a command, what it does, and how long it takes on two cores.
struct Beginning {
  const char *command, *line, *does;
};
constexpr Beginning beginnings[] = {
    {"choose", "penumbra choose mesh.obj --light sky.hdr --error 2%",
     "the cheapest technique within 2 % of error, for your mesh and your light: about a minute"},
    {"run", "penumbra run quick", "time and error of every family on three scenes: about a minute"},
    {"init", "penumbra init my-study", "a scene and a suite with comments, to change and to run: at once"},
    {"list", "penumbra list", "techniques, scenes and suites; penumbra list NAME: all of one: at once"},
};

class Format : public CLI::Formatter {
 public:
  std::string make_help(const CLI::App* app, std::string name, CLI::AppFormatMode mode) const override {
    if (!app->get_parent()) return first_screen(*app);
    std::string text = CLI::Formatter::make_help(app, std::move(name), mode);
    while (text.ends_with("\n\n")) text.pop_back();
    return text;
  }

  std::string make_description(const CLI::App* app) const override {
    return wrapped(app->get_description() + ".", screen_width()) + "\n";
  }

  std::string make_usage(const CLI::App* app, std::string) const override {
    std::string text = "usage: penumbra " + app->get_name();
    for (const CLI::Option* o : app->get_options()) {
      if (o->get_positional()) text += " " + make_option_usage(o);
      else if (o->get_required()) text += fmt::format(" {} {}", o->get_name(), value_of(*o));
    }
    return "\n" + wrapped(text + " [options]", screen_width(), 7) + "\n";
  }

  std::string make_positionals(const CLI::App* app) const override {
    std::string text;
    for (const CLI::Option* o : app->get_options())
      if (o->get_positional()) text += make_option(o, true);
    return text;
  }

  std::string make_group(std::string, bool, std::vector<const CLI::Option*> options) const override {
    std::string text = "\noptions\n";
    for (const CLI::Option* o : options) text += make_option(o, false);
    return text;
  }

  std::string make_option(const CLI::Option* o, bool positional) const override {
    const std::string value = positional ? "" : value_of(*o);
    std::string label = positional ? o->get_name() : o->get_name(false, true);
    if (!value.empty()) label += " " + value;
    return labelled(label, about(*o), 24, screen_width());
  }

 private:
  /// "INT", "TEXT ...": the kind of value, without what is checked.
  static std::string value_of(const CLI::Option& o) {
    if (o.get_type_size() == 0) return "";
    const std::string type = o.get_type_name();
    return type.substr(0, type.find(':')) + (o.get_expected_max() > 1 ? " ..." : "");
  }

  /// What an option is for, what is allowed, and what holds without it.
  static std::string about(const CLI::Option& o) {
    std::string text = o.get_description();
    const std::string type = o.get_type_name();
    if (const auto check = type.find(':'); check != std::string::npos) text += "; " + type.substr(check + 1);
    if (!o.get_default_str().empty()) text += "; default: " + o.get_default_str();
    if (o.get_required()) text += " (required)";
    return text;
  }
};

}  // namespace

std::string first_screen(const CLI::App& app) {
  const int width = screen_width();
  std::string text = wrapped(app.get_description() + ".", width) + "\n\nbegin with (times of 2 cores)\n";
  const std::vector<const CLI::App*> commands = app.get_subcommands({});
  for (const Beginning& b : beginnings)
    if (std::any_of(commands.begin(), commands.end(), [&](const auto* c) { return c->get_name() == b.command; }))
      text += fmt::format("  {}\n      {}\n", b.line, wrapped(b.does, width, 6, 6));
  text += "\ncommands\n";
  for (const CLI::App* command : commands) text += labelled(command->get_name(), command->get_description(), 15, width);
  const char* more = "penumbra COMMAND --help: its options. penumbra --version: build, processor, CUDA.";
  return text + "\n" + wrapped(more, width) + "\n";
}

void format_help(CLI::App& app) {
  app.formatter(std::make_shared<Format>());
}

std::string version_text() {
  const auto machine = describe_machine(make_registry());
  const auto line = [&, width = screen_width()](const char* label, const std::string& text) {
    return labelled(label, text, 20, width);
  };
  const std::string changed = machine.at("dirty") == "true" ? " (with changes)" : "";
  return "penumbra " PENUMBRA_VERSION "\n" + line("commit", machine.at("commit") + changed) +
         line("compiler", machine.at("compiler") + ", " + machine.at("build_type") + ", " + machine.at("flags")) +
         line("processor", machine.at("cpu_name")) + line("instruction sets", machine.at("instruction_sets")) +
         line("cuda", machine.at("cuda"));
}

}  // namespace penumbra
