// penumbra run: the options of a suite's run.
#include <CLI/CLI.hpp>

#include "harness/catalogue/catalogue.h"
#include "harness/commands/commands.h"
#include "harness/commands/dry_run.h"
#include "harness/commands/input_kind.h"
#include "harness/commands/run.h"

namespace penumbra {

void add_run(CLI::App& app, int& exit_code) {
  auto* command = app.add_subcommand("run", "Measure a suite: time and error of every variant");
  static std::string suite;
  static RunOptions options;
  static std::vector<std::string> scenes;
  static int threads = 0;
  static bool dry = false;
  command->add_option("suite", suite, "Shipped suite or path of a .toml file")->required();
  command->add_option("--out", options.directory, "Folder for results")->default_val("results/runs/latest");
  command->add_option("--filter", options.filter, "Regular expression searched in row names, also with all parameters");
  command->add_option("--repetitions", options.repetitions, "Repetitions per row (default: the suite's)")
      ->check(CLI::Range(1, 1000));
  command->add_option("--threads", threads, "Threads of parallel backends (default: the suite's)")
      ->check(CLI::Range(1, 1024));
  command->add_option("--scene", scenes, "Shipped scene or path, in place of the suite's own; may be repeated");
  command->add_flag("--dry-run", dry, "Say what would be measured and about how long it takes; measure nothing");
  command->add_flag("--resume", options.resume, "Keep the good rows of the folder");
  command->callback([&exit_code] {
    const Registry registry = make_registry();
    expect_suite(suite, registry);
    for (const std::string& scene : scenes) expect_scene(scene, registry);
    const Suite loaded = load_suite(suite, registry, threads, scenes);
    if (dry) dry_run(loaded, options);
    else exit_code = run_suite(loaded, registry, options);
  });
}

}  // namespace penumbra
