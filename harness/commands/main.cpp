// The command line. Each command has a file of its own: see commands.h.
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <unistd.h>

#include <CLI/CLI.hpp>

#include "harness/commands/commands.h"
#include "harness/commands/help_format.h"
#include "harness/commands/mistakes.h"
#include "harness/measure/progress.h"
#include "harness/report/screen.h"
#include "scenes/error.h"

namespace {

/// On a terminal as wide as that is, elsewhere on one line.
int complain(const std::string& what, int exit_code) {
  const std::optional<int> width = penumbra::terminal_width(STDERR_FILENO);
  const std::string text = "penumbra: " + what;
  fmt::print(stderr, "{}\n", width ? penumbra::wrapped(text, *width, 2) : text);
  return exit_code;
}

}  // namespace

int main(int argc, char** argv) {
  using namespace penumbra;
  spdlog::set_default_logger(message_logger());  // stdout is for results
  spdlog::set_pattern("%v");
  CLI::App app{"penumbra: speed against error of shadow techniques"};
  format_help(app);
  app.set_version_flag("--version", version_text);
  app.require_subcommand(1);
  int exit_code = 0;
  add_choose(app, exit_code);
  add_run(app, exit_code);
  add_compare(app, exit_code);
  add_report(app, exit_code);
  add_serve_rows(app, exit_code);
  add_render(app, exit_code);
  add_reference(app, exit_code);
  add_fit(app, exit_code);
  add_sheet(app, exit_code);
  add_list(app, exit_code);
  add_init(app, exit_code);
  add_help(app, exit_code);
  add_export(app, exit_code);
  add_score(app, exit_code);
  add_export_rows(app, exit_code);
  try {
    if (argc == 1) throw CLI::CallForHelp();
    expect_command(app, argv[1]);
    app.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    return e.get_exit_code() == 0 ? app.exit(e) : complain(explained(app, e), 2);
  } catch (const Unsupported& e) {
    return complain(e.what(), 2);
  } catch (const Error& e) {
    return complain(e.what(), 2);
  } catch (const std::exception& e) {
    return complain(e.what(), 1);
  }
  return exit_code;
}
