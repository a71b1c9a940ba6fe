// penumbra run: the options of a suite's run.
#include <CLI/CLI.hpp>

#include "harness/commands/commands.h"
#include "harness/commands/run.h"

namespace penumbra {

void add_run(CLI::App& app, int& exit_code) {
  auto* command = app.add_subcommand("run", "Measure a suite: time and error of every variant");
  static std::string suite;
  static RunOptions options;
  static int threads = 0;
  command->add_option("suite", suite, "Shipped suite or path of a .toml file")->required();
  command->add_option("--out", options.directory, "Folder for results")->default_val("results/runs/latest");
  command->add_option("--filter", options.filter, "Regular expression searched in row names");
  command->add_option("--repetitions", options.repetitions, "Repetitions per row (default: the suite's)")
      ->check(CLI::Range(1, 1000));
  command->add_option("--threads", threads, "Threads of parallel backends (default: the suite's)")
      ->check(CLI::Range(1, 1024));
  command->add_flag("--resume", options.resume, "Keep the good rows of the folder");
  command->callback([&exit_code] {
    const Registry registry = make_registry();
    exit_code = run_suite(load_suite(suite, registry, threads), registry, options);
  });
}

}  // namespace penumbra
