// penumbra score: an image of someone else's renderer, measured like those of a run.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <filesystem>

#include "harness/catalogue/catalogue.h"
#include "harness/commands/commands.h"
#include "harness/commands/frame_option.h"
#include "harness/measure/check.h"
#include "harness/measure/chosen_frame.h"
#include "harness/measure/foreign_image.h"
#include "harness/measure/progress.h"
#include "harness/measure/scene_images.h"
#include "harness/measure/timing.h"
#include "harness/report/score_text.h"
#include "harness/results/results_folder.h"
#include "harness/results/row_json.h"
#include "scenes/error.h"
#include "scenes/names.h"
#include "scenes/scene_file.h"
#include "scenes/storage/content_key.h"

namespace penumbra {
namespace {

struct ScoreOptions {
  std::string scene, image, name, directory;
  std::vector<double> time_ms;
  double noise = Suite().truth_noise;
  int resolution = resolution_of({});
  std::optional<int> frame;  ///< absent: the one that `run` scores
  bool json = false;
};

std::string checked_name(const ScoreOptions& options) {
  std::string name = options.name.empty() ? std::filesystem::path(options.image).stem().string() : options.name;
  if (const std::string fault = name_fault(name); !fault.empty()) throw Error("--name {}", fault);
  return name;
}

void check_times(const std::vector<double>& times) {
  for (const double ms : times)
    if (!std::isfinite(ms) || ms <= 0.0) throw Error("--time {}: a frame takes a positive number of milliseconds", ms);
}

/// A suite of this one image. What is not as in a run is a parameter of the row.
Suite suite_of(const ScoreOptions& options, const Animation& animation) {
  Suite suite;
  suite.name = "score", suite.truth_noise = options.noise;
  Variant variant = variant_of(make_external(checked_name(options)));
  if (options.resolution != resolution_of({})) variant.parameters.set("resolution", options.resolution);
  if (const int frame = chosen_frame(animation, options.frame); frame != scored_frame(animation))
    variant.parameters.set("frame", frame);
  suite.variants.push_back(std::move(variant));
  return suite;
}

/// All rungs that the scene has.
void add_references(SceneContext& context, int resolution, Progress& progress) {
  for (const Rung rung : {Rung::truth, Rung::r13x13, Rung::cube, Rung::spheres}) {
    const bool texels = rung == Rung::cube || rung == Rung::spheres;
    if (!inapplicable(context.frame(), rung).empty()) continue;
    progress.step(to_string(rung));
    context.add_reference(rung, texels ? resolution : 0, [&](double share) { progress.share(share); });
  }
}

Row scored_row(const SceneContext& context, const Suite& suite, const Image& image, const std::vector<double>& times) {
  Row row = empty_row(suite.variants[0], context, suite);
  row.score = context.score(image, suite.variants[0].parameters);
  row.timing.frame_ms = times;
  row.timing.iterations = times.empty() ? 0 : 1;
  ContentHash hash;
  hash.add(row.facts.key), hash.add(image.pixels);
  row.facts.key = hash.digest();
  return row;
}

/// What --noise a row's truth may have had: suites call it truth_noise.
std::string noise_of_truth(const Row& row) {
  const auto truth = row.score.errors.find("truth");
  if (truth == row.score.errors.end() || !truth->second.rel_noise) return "";
  return fmt::format(": theirs is {:.2g}, at most their suite's truth_noise", *truth->second.rel_noise);
}

/// Rows of a folder that the image joins. Throws Error if those of its scene were measured against another truth.
Results rows_beside(const std::string& directory, const SceneContext& context) {
  Results results = read_results(directory);
  const std::string truth = context.key().substr(0, context.key().find('-'));
  for (const Row& row : results.rows)
    if (row.ok() && row.id.scene == context.scene().name && !row.facts.scene_key.starts_with(truth))
      throw Error(
          "{}/results.json: its rows of scene '{}' were measured against another truth (the scene, its frame or "
          "--noise is another{}); choose another folder with --out",
          directory, context.scene().name, noise_of_truth(row));
  if (results.rows.empty()) {
    results.context = machine_context(make_registry());
    results.context["suite"] = "score";
  }
  return results;
}

int score(const ScoreOptions& options) {
  check_times(options.time_ms);
  Progress progress;
  Scene scene = load_scene(options.scene, {}, progress);
  const Suite suite = suite_of(options, Animation(scene));
  SceneContext context(std::move(scene), suite, options.frame);
  const Image image = load_foreign_image(options.image, context.frame().receivers, context.scene().name);
  ResultsFolder folder(options.directory);
  const Results earlier = rows_beside(options.directory, context);
  add_references(context, options.resolution, progress);
  context.finish_references(progress);
  progress.finish();

  Row row = scored_row(context, suite, image, options.time_ms);
  SceneImages images(suite, options.directory, context);
  row.facts.image = images.stem(suite.variants[0]);
  images.save_truth();
  images.save(suite.variants[0], image);
  folder.begin(earlier.context, earlier.rows);
  folder.expect({row.id.name()});
  folder.add(row);
  if (const std::string why = folder.save(); !why.empty()) throw std::runtime_error(why);

  const int frame = int(context.frame().time);
  const std::string stem = options.directory + "/" + row.facts.image;
  if (options.json) {
    nlohmann::json out = to_json(row);
    out["frame"] = frame, out["error_map"] = {stem + ".error.exr", stem + ".error.png"};
    fmt::print("{}\n", out.dump(1, ' ', false, nlohmann::json::error_handler_t::replace));
  } else {
    const std::string which = frame_text(context.animation(), frame);
    fmt::print("{}: scene '{}'{}{}, {} receivers\n{}Error map: {}.error.png and .exr\nRow: {}/results.json\n",
               options.image, row.id.scene, which.empty() ? "" : ", ", which, row.id.receivers,
               make_score_text(row, folder.all_rows()), stem, options.directory);
  }
  return 0;
}

}  // namespace

void add_score(CLI::App& app, int& exit_code) {
  auto* command = app.add_subcommand("score", "Measure an image that another renderer made of a scene");
  static ScoreOptions options;
  command->add_option("scene", options.scene, "Shipped scene or path of a .toml file")->required();
  command->add_option("image", options.image, "Linear radiance in floats: .exr or .pfm")->required();
  command->add_option("--time", options.time_ms, "A frame's time in ms; once for every sample")
      ->allow_extra_args(false);
  command->add_option("--name", options.name, "What its row is called (default: the image's name)");
  add_frame_option(*command, options.frame);
  command->add_option("--noise", options.noise, "Of the truth: standard error relative to RMS")
      ->check(CLI::Range(1e-5, 1.0));
  command->add_option("--resolution", options.resolution, "Texels along a face edge of the rungs cube and spheres")
      ->check(CLI::IsMember({16, 32, 64}));
  command->add_option("--out", options.directory, "Folder whose rows it joins")->default_val("results/runs/latest");
  command->add_flag("--json", options.json, "Print the row as JSON");
  command->callback([&exit_code] { exit_code = score(options); });
}

}  // namespace penumbra
