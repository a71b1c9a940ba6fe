// penumbra choose: a scene for a mesh and a light, the search, and the screen.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <thread>

#include "harness/catalogue/catalogue.h"
#include "harness/choose/choose.h"
#include "harness/choose/new_scene.h"
#include "harness/commands/answer_screen.h"
#include "harness/commands/commands.h"
#include "harness/measure/interrupt.h"
#include "harness/measure/timing.h"
#include "harness/report/row_text.h"
#include "harness/report/screen.h"
#include "harness/results/text.h"
#include "scenes/error.h"
#include "scenes/scene_outline.h"
#include "scenes/storage/atomic_write.h"

namespace penumbra {
namespace {

struct ChooseOptions {
  std::string subject;  ///< mesh or scene
  SceneRequest scene;   ///< for a mesh
  std::string error, budget;
  std::string directory = "results/runs/choose";
  ChooseSettings settings;
  bool json = false, path = false;
};

Bound bound_of(const ChooseOptions& o) {
  if (!o.error.empty() && !o.budget.empty())
    throw Error(
        "--error and --budget: one bound is allowed; it is the fastest within an error, or the best within a time");
  if (o.error.empty() && o.budget.empty())
    throw Error(
        "choose needs a bound: either --error 2% (the fastest within it) or --budget 10ms (the best within it)");
  return o.error.empty() ? parse_time_bound(o.budget) : parse_error_bound(o.error);
}

/// The scene that is given, or one that is written for the mesh.
std::string scene_of(const ChooseOptions& o) {
  if (!names_scene(o.subject)) {
    make_folder(o.directory);
    return write_scene(o.scene, o.directory);
  }
  const SceneRequest& s = o.scene;
  if (!s.light.empty() || !s.lamp.empty() || s.up != "y" || s.height != 0.0)
    throw Error("{} is a scene and brings its own light and size; --light, --lamp, --up and --height are for a mesh",
                o.subject);
  return o.subject;
}

/// What was looked at, in order: the search's path.
std::string path_text(const std::vector<Row>& rows) {
  TextTable table({{"spheres", 7, Align::right},
                   {"variant", screen_width() - 32, Align::left},
                   {"ms", 7, Align::right},
                   {"error %", 9, Align::right}},
                  screen_width());
  std::vector<const Row*> all(rows.size());
  std::transform(rows.begin(), rows.end(), all.begin(), [](const Row& row) { return &row; });
  for (const Row& row : rows)
    table.row({row.id.reads_spheres ? std::to_string(row.id.spheres) : "",
               row.id.technique + " " + telling_parameters(row, all), three_digits(row.timing.median_frame_ms()),
               row.score.truth_error() ? three_digits(100.0 * *row.score.truth_error()) : row.status});
  return table.text();
}

int finish(const ChooseOptions& o, const Answer& answer, ResultsFolder& folder) {
  std::string unwritten = folder.save();
  const std::string json = to_json(answer).dump(1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
  try {
    write_atomically(o.directory + "/choice.json", json);
    write_atomically(o.directory + "/choice.txt", screen_of(answer, screen_width()));
  } catch (const std::exception& e) {
    unwritten = e.what();
  }
  if (o.path && !o.json) std::fputs((path_text(folder.rows()) + "\n").c_str(), stdout);
  std::fputs(o.json ? json.c_str() : screen_of(answer, screen_width()).c_str(), stdout);
  const bool unprinted = std::fflush(stdout) != 0;
  if (!unwritten.empty()) say(fmt::format("the results are not on disk: {}\n", unwritten));
  return unprinted || !unwritten.empty() ? 1 : 0;
}

/// Returns the exit code: 0 answered, be it that nothing reaches the bound, 1 results could not be written, 130
/// interrupted.
int choose_technique(ChooseOptions o) {
  o.settings.bound = bound_of(o);
  o.scene.mesh = o.subject;
  o.scene.moving = o.settings.moving;
  if (o.settings.threads < 1) o.settings.threads = std::max(1, int(std::thread::hardware_concurrency()));
  const Registry registry = make_registry();
  o.settings.scene = scene_of(o);
  const SceneOutline outline = read_outline(o.settings.scene);
  ResultsFolder folder(o.directory);
  nlohmann::json context = machine_context(registry);
  context["suite"] = "choose";
  folder.begin(context, {});
  const auto kept = [&] {
    folder.save();
    say(fmt::format("interrupted: what was tried is in {}/results.json\n", o.directory));
  };
  try {
    const InterruptWatch watch([] { say("\nstopping (once more: stop at once)\n"); }, kept);
    Answer answer;
    {
      Progress progress;
      answer = choose(o.settings, registry, folder, progress);
    }
    answer.scene_spheres = int(outline.spheres);
    answer.busy = context.at("busy").get<bool>();
    return finish(o, answer, folder);
  } catch (const Interrupted&) {
    kept();
    return 130;
  }
}

}  // namespace

void add_choose(CLI::App& app, int& exit_code) {
  auto* command = app.add_subcommand(
      "choose", "The technique for a mesh and a light: fastest within an error, or best within a time");
  static ChooseOptions options;
  command->add_option("subject", options.subject, "Mesh (file, asset, shape) or scene (shipped, .toml)")->required();
  command->add_option("--error", options.error, "Bound: relative RMSE against truth, such as 2%");
  command->add_option("--budget", options.budget, "Bound: time of a frame, such as 10ms");
  command->add_option("--light", options.scene.light,
                      "For a mesh: environment, a name or an image file (default: sun-sky)");
  command->add_option("--lamp", options.scene.lamp, "For a mesh: WxH@x,y,z or RADIUS@x,y,z, m, shining at the mesh");
  command->add_option("--up", options.scene.up, "For a mesh: its upward axis")->check(CLI::IsMember({"y", "z"}));
  command->add_option("--height", options.scene.height, "For a mesh: scale it to this height, m")
      ->check(CLI::Range(1e-6, 1e6));
  command->add_flag("--moving", options.settings.moving, "The mesh deforms: count what every frame must update");
  command->add_option("--out", options.directory, "Folder for scene, rows and answer")->capture_default_str();
  command->add_option("--threads", options.settings.threads, "Default: all cores")->check(CLI::Range(1, 1024));
  command->add_option("--repetitions", options.settings.repetitions, "Of the candidates' timing")
      ->check(CLI::Range(1, 1000));
  command->add_option("--patience", options.settings.patience, "Seconds after which no further spheres are fitted")
      ->check(CLI::Range(1.0, 1e6));
  command->add_flag("--exhaustive", options.settings.exhaustive, "Try every combination instead of searching (slow)");
  command->add_flag("--path", options.path, "Print all that was tried");
  command->add_flag("--json", options.json, "Print the answer as JSON");
  command->callback([&exit_code] { exit_code = choose_technique(options); });
}

}  // namespace penumbra
