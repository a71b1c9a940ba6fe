// penumbra reference: one rung of the reference ladder.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <nlohmann/json.hpp>

#include "harness/catalogue/catalogue.h"
#include "harness/commands/commands.h"
#include "harness/commands/frame_option.h"
#include "harness/commands/input_kind.h"
#include "harness/commands/save_image.h"
#include "harness/measure/black_truth.h"
#include "harness/measure/chosen_frame.h"
#include "harness/measure/progress.h"
#include "harness/measure/reference.h"
#include "harness/results/metrics.h"
#include "scenes/error.h"
#include "scenes/log.h"
#include "scenes/scene_file.h"

namespace penumbra {
namespace {

struct ReferenceOptions {
  std::string scene, rung = "truth", output;
  double noise = 0.002;
  int resolution = 32;
  std::optional<int> frame;  ///< absent: the one that `run` scores
  bool fresh = false, json = false;
};

std::string reference_line(const std::string& scene, const Reference& r, const std::vector<bool>& valid, double black) {
  const double scale = rms(r.mean, valid);
  const auto error = relative(r.noise(valid), scale, black);
  const auto average = mean(r.mean, valid);
  return fmt::format(
      "{} {}: {} receivers, {} rays each, {:.2f} s{}, RMS {:.5g} W m^-2 sr^-1, standard error {}, mean {}", scene,
      to_string(r.rung), valid.size(), r.rays_per_receiver, r.seconds, r.from_cache ? " (from the cache)" : "", scale,
      error ? fmt::format("{:.3g} % of it", 100.0 * *error) : "undefined (of a black image)",
      average ? fmt::format("({:.5g}, {:.5g}, {:.5g})", average->x, average->y, average->z) : "undefined");
}

/// The same figures, and null where they are undefined.
nlohmann::json reference_json(const std::string& scene, const Reference& r, const std::vector<bool>& valid,
                              double black) {
  const double scale = rms(r.mean, valid);
  const auto error = relative(r.noise(valid), scale, black);
  const auto average = mean(r.mean, valid);
  return {{"scene", scene},
          {"rung", to_string(r.rung)},
          {"receivers", valid.size()},
          {"valid_receivers", std::count(valid.begin(), valid.end(), true)},
          {"rays_per_receiver", r.rays_per_receiver},
          {"seconds", r.seconds},
          {"from_cache", r.from_cache},
          {"rms", scale},
          {"mean", average ? nlohmann::json{average->x, average->y, average->z} : nlohmann::json(nullptr)},
          {"noise", r.noise(valid)},
          {"rel_noise", error ? nlohmann::json(*error) : nlohmann::json(nullptr)},
          {"black", !(scale > black)}};
}

void reference(const ReferenceOptions& options) {
  expect_scene(options.scene, make_registry());
  Progress progress;
  const Scene scene = load_scene(options.scene, {}, progress);
  const Rung rung = parse_rung(options.rung);
  ReferenceSettings settings;
  settings.truth_noise = options.noise;
  settings.resolution = options.resolution;
  Animation animation(scene);
  const int index = chosen_frame(animation, options.frame);
  const Frame frame = animation.frame(index);
  if (const std::string why = inapplicable(frame, rung); !why.empty()) throw Unsupported(why);
  progress.step(fmt::format("{}: {}", scene.name, to_string(rung)));
  const auto tell = [&](double share) { progress.share(share); };
  const Reference r =
      options.fresh ? compute_reference(frame, rung, settings, tell) : cached_reference(frame, rung, settings, tell);
  progress.finish();
  const auto valid = valid_receivers(frame.receivers);
  const double black = black_level(frame.light, frame.receivers);
  const std::string which = frame_text(animation, index);
  const std::string title = which.empty() ? scene.name : scene.name + " " + which;
  nlohmann::json figures = reference_json(scene.name, r, valid, black);
  figures["frame"] = index;
  fmt::print("{}\n", options.json ? figures.dump(1) : reference_line(title, r, valid, black));
  if (!(rms(r.mean, valid) > black))
    warn("{}", black_note(scene.name, frame.light, frame.receivers, rms(r.unshadowed, valid) > black));
  if (!options.output.empty()) save_image(options.output, r.mean, frame);
}

}  // namespace

void add_reference(CLI::App& app, int&) {
  auto* command = app.add_subcommand("reference", "Compute (or fetch from the cache) a rung of the reference ladder");
  static ReferenceOptions options;
  command->add_option("scene", options.scene, "Shipped scene or path of a .toml file")->required();
  command->add_option("--rung", options.rung, "truth, 13x13, cube or spheres")->default_val("truth");
  command->add_option("--noise", options.noise, "truth: standard error relative to RMS")->check(CLI::Range(1e-5, 1.0));
  command->add_option("--resolution", options.resolution, "cube, spheres: texels along a face edge")
      ->check(CLI::IsMember({16, 32, 64}));
  add_frame_option(*command, options.frame);
  command->add_flag("--fresh", options.fresh, "Do not look into the cache");
  command->add_flag("--json", options.json, "Print the figures as JSON");
  command->add_option("-o", options.output, "Image: .exr or .png");
  command->callback([] { reference(options); });
}

}  // namespace penumbra
