// The command line: penumbra list | run | render | reference | fit.
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <iostream>
#include <thread>

#include "cuda/register_cuda.h"
#include "harness/commands/commands.h"
#include "harness/commands/run.h"
#include "harness/measure/progress.h"
#include "scenes/error.h"

namespace {

using namespace penumbra;

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

void add_render(CLI::App& app) {
  auto* command = app.add_subcommand("render", "Shade one scene with one technique");
  static RenderOptions options;
  static std::vector<std::string> parameters;
  command->add_option("scene", options.scene, "Shipped scene or path of a .toml file")->required();
  command->add_option("--technique", options.technique, "See: penumbra list")->required();
  command->add_option("--backend", options.backend, "scalar, simd or cuda")->default_val("simd");
  command->add_option("-p", parameters, "Parameter, name=value");
  command->add_option("-o", options.output, "Image: .exr (linear) or .png (exposed)")->required();
  command->callback([] {
    options.parameters = parse_parameters(parameters);
    render(options);
  });
}

void add_reference(CLI::App& app) {
  auto* command = app.add_subcommand("reference", "Compute (or fetch from the cache) a rung of the reference ladder");
  static ReferenceOptions options;
  command->add_option("scene", options.scene, "Shipped scene or path of a .toml file")->required();
  command->add_option("--rung", options.rung, "truth, 13x13, cube or spheres")->default_val("truth");
  command->add_option("--noise", options.noise, "truth: standard error relative to RMS")->check(CLI::Range(1e-5, 1.0));
  command->add_option("--resolution", options.resolution, "cube, spheres: texels along a face edge")
      ->check(CLI::IsMember({16, 32, 64}));
  command->add_flag("--fresh", options.fresh, "Do not look into the cache");
  command->add_flag("--json", options.json, "Print the figures as JSON");
  command->add_option("-o", options.output, "Image: .exr or .png");
  command->callback([] { reference(options); });
}

void add_fit(CLI::App& app) {
  auto* command = app.add_subcommand("fit", "Fit spheres to a mesh");
  static FitOptions options;
  static std::string objective, assignment;
  command->add_option("mesh", options.mesh, "Asset name, shape or mesh file")->required();
  command->add_option("--spheres", options.request.spheres, "How many")->required()->check(CLI::Range(1, 4096));
  command->add_option("--objective", objective, std::string("What to fit for: ") + objective_names)
      ->default_val(to_string(options.request.objective));
  command->add_option("--assignment", assignment, "cover: nearest, or flood as published")
      ->default_val("nearest")
      ->check(CLI::IsMember({"nearest", "flood"}));
  command->add_option("--seed", options.request.seed, "Same seed, same spheres")->default_val(1);
  command->add_option("-o", options.output, "JSON file for scene files; a picture of the same name beside it")
      ->required();
  command->callback([] {
    options.request.objective = parse_objective(objective);
    options.request.assignment = assignment == "flood" ? Assignment::flood : Assignment::nearest;
    fit(options);
  });
}

}  // namespace

int main(int argc, char** argv) {
  spdlog::set_default_logger(message_logger());  // stdout is for results
  spdlog::set_pattern("%v");
  CLI::App app{"penumbra: speed against error of shadow techniques"};
  app.require_subcommand(1);
  int exit_code = 0;
  bool json = false;
  auto* listing = app.add_subcommand("list", "Techniques, scenes and suites of this build");
  listing->add_flag("--json", json, "Machine-readable");
  listing->callback([&] { list(json); });
  add_run(app, exit_code);
  add_render(app);
  add_reference(app);
  add_fit(app);
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
