// penumbra fit: spheres for a mesh, what they are worth, and a picture.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <filesystem>

#include "harness/commands/commands.h"
#include "harness/commands/fit_picture.h"
#include "harness/measure/progress.h"
#include "scenes/assets.h"
#include "scenes/error.h"
#include "scenes/fit/fit.h"

namespace penumbra {
namespace {

struct FitOptions {
  std::string mesh;    ///< asset, shape or file
  std::string output;  ///< .json; beside it a picture of the same name in .png
  FitRequest request;
};

/// Fits spheres, writes them and a picture, prints what they are worth.
void fit(const FitOptions& options) {
  if (!options.output.ends_with(".json")) throw Error("-o {}: the name must end in .json", options.output);
  Progress progress;
  progress.step("loading " + options.mesh);
  const Mesh mesh = mesh_by_name(options.mesh);
  progress.step(fmt::format("fitting {} spheres", options.request.spheres));
  const auto start = std::chrono::steady_clock::now();
  const SphereSet set = fit_spheres(mesh, options.request, options.mesh,
                                    [&](const std::string& stage, double share) { progress.share(stage, share); });
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  progress.step("measuring and drawing the fit");
  save_spheres(options.output, set, mesh.origin);
  const std::string picture = std::filesystem::path(options.output).replace_extension(".png").string();
  save_png(picture, draw_fit(mesh, set, 480));
  const FitQuality quality = assess_fit(mesh, set, options.mesh);
  progress.finish();
  const auto percent = [&](double volume) { return quality.volume > 0.0 ? 100.0 * volume / quality.volume : 0.0; };
  fmt::print(
      "{}: {} spheres for {} in {:.2f} s, seed {}\n"
      "  volume of the solid  {:.6g} m^3\n"
      "  outside, summed      {:.6g} m^3 ({:.2f} %)\n"
      "  outside, of union    {:.6g} m^3 ({:.2f} %)\n"
      "  uncovered            {:.6g} m^3 ({:.3f} %; coverage {:.3f} %)\n"
      "  picture              {}\n",
      options.output, set.size(), to_string(options.request.objective), seconds, options.request.seed, quality.volume,
      quality.outside, percent(quality.outside), quality.excess, percent(quality.excess), quality.uncovered,
      percent(quality.uncovered), 100.0 * quality.coverage(), picture);
}

}  // namespace

void add_fit(CLI::App& app, int&) {
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

}  // namespace penumbra
