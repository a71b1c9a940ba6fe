#include "harness/run.h"

#include <fmt/format.h>

#include <filesystem>
#include <optional>
#include <regex>

#include "harness/interrupt.h"
#include "harness/published.h"
#include "harness/published_times.h"
#include "harness/scene_run.h"
#include "scenes/error.h"
#include "scenes/scene_file.h"

namespace penumbra {
namespace {

/// A scene and what is to be measured on it.
struct Case {
  Scene scene;
  std::vector<Variant> variants;
};

std::regex checked_regex(const std::string& text) {
  try {
    return std::regex(text);
  } catch (const std::regex_error& e) {
    throw Error("--filter '{}' is not a regular expression: {}", text, e.what());
  }
}

std::vector<Case> load_cases(const Suite& suite, const std::string& filter) {
  const std::regex wanted = checked_regex(filter);
  std::vector<Case> cases;
  for (const std::string& name : suite.scenes)
    for (const auto& spheres : suite.spheres) {
      Case item{load_scene(name, spheres), {}};
      for (const Variant& variant : suite.variants) {
        Row row;
        row.scene = item.scene.name, row.spheres = item.scene.spheres.size(), row.objective = item.scene.objective;
        row.technique = variant.entry->name, row.backend = variant.entry->backend;
        row.parameters = variant.parameters, row.threads = variant.threads;
        if (std::regex_search(row.name(), wanted)) item.variants.push_back(variant);
      }
      if (!item.variants.empty()) cases.push_back(std::move(item));
    }
  if (cases.empty()) throw Error("--filter '{}' leaves nothing of suite '{}'", filter, suite.name);
  return cases;
}

std::string image_folder(const RunOptions& options, const Scene& scene) {
  return fmt::format("{}/images/{}-{}-spheres{}{}", options.directory, scene.name, scene.spheres.size(),
                     scene.objective.empty() ? "" : "-", scene.objective);
}

/// Rows of an earlier run whose name and inputs are the same; their variants are taken out.
std::vector<Row> take_finished(const std::vector<Row>& earlier, const SceneRun& run, std::vector<Variant>& variants) {
  std::vector<Row> kept;
  std::erase_if(variants, [&](const Variant& variant) {
    const std::string name = run.empty_row(variant).name();
    for (const Row& row : earlier)
      if (row.name() == name && row.scene_key == run.key() && row.ok()) {
        kept.push_back(row);
        return true;
      }
    return false;
  });
  return kept;
}

}  // namespace

int run_suite(const Suite& suite, const Registry& registry, const RunOptions& options) {
  const auto published = suite.published.empty() || !suite.published_times.empty()
                             ? std::optional<PublishedTable>()
                             : PublishedTable::load(suite.published);
  if (!suite.published_times.empty()) check_published_times(suite);
  const auto tables = [&](const std::vector<Row>& rows) -> std::string {
    std::string text = make_table(rows) + make_choice_table(rows) +
                       (suite.baseline ? make_baseline_table(suite.baseline->entry->name, rows) : "") +
                       make_stages_table(rows) + make_sequence_table(rows) + make_steps_table(rows) +
                       make_counters_table(rows);
    if (suite.published_times.empty()) return text + (published ? make_published_table(*published, rows) : "");
    return text + make_published_times_table(suite, rows);
  };
  std::vector<Case> cases = load_cases(suite, options.filter);
  const std::vector<Row> earlier = options.resume ? read_results(options.directory) : std::vector<Row>();
  const int repetitions = options.repetitions > 0 ? options.repetitions : suite.repetitions;
  int steps = 0;
  for (const Case& item : cases) steps += SceneRun::steps(item.variants.size(), repetitions) + (suite.baseline ? 1 : 0);

  watch_interrupts();
  std::filesystem::create_directories(options.directory + "/images");
  nlohmann::json context = machine_context();
  context["suite"] = suite.name;
  std::vector<Row> rows;
  {
    Progress progress(steps);
    for (Case& item : cases) {
      if (interrupted()) break;
      SceneRun run(item.scene, registry, suite, image_folder(options, item.scene));
      const std::vector<Row> kept = take_finished(earlier, run, item.variants);
      rows.insert(rows.end(), kept.begin(), kept.end());
      if (item.variants.empty()) continue;
      run.make_references(item.variants, progress);
      if (suite.baseline) run.make_baseline(*suite.baseline, progress);
      if (suite.sequence) run.make_sequence(progress);
      const std::vector<Row> measured = run.measure(item.variants, repetitions, progress);
      rows.insert(rows.end(), measured.begin(), measured.end());
      write_results(options.directory, context, rows);
      write_atomically(options.directory + "/table.md", tables(rows));
    }
  }
  fmt::print("{}", tables(rows));
  if (interrupted()) {
    fmt::print(stderr, "interrupted: {} finished rows are in {}/results.json; --resume goes on\n", rows.size(),
               options.directory);
    return 130;
  }
  return std::any_of(rows.begin(), rows.end(), [](const Row& r) { return r.status.starts_with("failed"); }) ? 1 : 0;
}

}  // namespace penumbra
