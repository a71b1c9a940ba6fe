// The command line. Each command has a file of its own: see commands.h.
#include <fmt/format.h>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>

#include "harness/commands/commands.h"
#include "scenes/error.h"

int main(int argc, char** argv) {
  using namespace penumbra;
  spdlog::set_default_logger(spdlog::stderr_color_mt("penumbra"));  // stdout is for results
  spdlog::set_pattern("%v");
  CLI::App app{"penumbra: speed against error of shadow techniques"};
  app.require_subcommand(1);
  int exit_code = 0;
  add_run(app, exit_code);
  add_render(app, exit_code);
  add_reference(app, exit_code);
  add_fit(app, exit_code);
  add_list(app, exit_code);
  add_export(app, exit_code);
  add_score(app, exit_code);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    return app.exit(e) == 0 ? 0 : 2;
  } catch (const Unsupported& e) {
    fmt::print(stderr, "penumbra: {}\n", e.what());
    return 2;
  } catch (const Error& e) {
    fmt::print(stderr, "penumbra: {}\n", e.what());
    return 2;
  } catch (const std::exception& e) {
    fmt::print(stderr, "penumbra: {}\n", e.what());
    return 1;
  }
  return exit_code;
}
