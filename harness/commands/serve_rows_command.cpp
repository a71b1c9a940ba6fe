// penumbra serve-rows: one of the two programs that `compare --ab` measures in turn. Not for people.
#include <sched.h>

#include <CLI/CLI.hpp>
#include <iostream>

#include "harness/catalogue/catalogue.h"
#include "harness/commands/commands.h"
#include "harness/measure/side_by_side/row_server.h"

namespace penumbra {
namespace {

/// Keeps this process and all threads that it starts on one processor. That it cannot be is no reason not to measure.
void stay_on(int processor) {
  cpu_set_t one;
  CPU_ZERO(&one);
  CPU_SET(processor, &one);
  sched_setaffinity(0, sizeof one, &one);
}

}  // namespace

void add_serve_rows(CLI::App& app, int&) {
  auto* command = app.add_subcommand("serve-rows", "Time rows of a suite as `compare --ab` asks for them on stdin");
  command->group("");  // not listed
  static std::string suite, filter = ".*";
  static int threads = 0, processor = -1;
  command->add_option("suite", suite, "Shipped suite or path of a .toml file")->required();
  command->add_option("--filter", filter, "Regular expression searched in row names");
  command->add_option("--threads", threads, "Threads of parallel backends (default: the suite's)");
  command->add_option("--processor", processor, "Stay on this one")->check(CLI::Range(0, CPU_SETSIZE - 1));
  command->callback([] {
    if (processor >= 0) stay_on(processor);
    const Registry registry = make_registry();
    const Suite loaded = load_suite(suite, registry, threads);
    serve_rows(make_plan(loaded, filter, 1), std::cin, std::cout);
  });
}

}  // namespace penumbra
