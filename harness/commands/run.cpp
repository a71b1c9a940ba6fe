#include "harness/commands/run.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <optional>
#include <regex>
#include <set>

#include "harness/measure/interrupt.h"
#include "harness/measure/scene_run.h"
#include "harness/report/published.h"
#include "harness/report/published_times.h"
#include "scenes/error.h"
#include "scenes/names.h"
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

/// Every scene once, and no two whose tables and image folders would be the same. Looks at names alone, so that nothing
/// is fitted for a suite that is refused.
void check_scene_names(const Suite& suite) {
  std::map<std::string, SceneName> seen;
  for (const std::string& listed : suite.scenes) {
    const SceneName scene = read_scene_name(listed);
    const auto [at, fresh] = seen.try_emplace(file_name_key(scene.name), scene);
    if (fresh) continue;
    const SceneName& other = at->second;
    if (std::filesystem::equivalent(other.file, scene.file))
      throw Error("{}: key 'scenes' lists {} twice; allowed is once (the key 'spheres' measures it with several sets)",
                  suite.scenes_where, listed);
    throw Error(
        "{}: key 'scenes' lists '{}' ({}) and '{}' ({}), which would share tables and images; allowed are names that "
        "differ in more than case and ' ', ':' or '-'",
        suite.scenes_where, other.name, other.where, scene.name, scene.where);
  }
}

std::string folder_name(const Scene& scene) {
  return fmt::format("{}-{}-spheres{}{}", scene.name, scene.spheres.size(), scene.objective.empty() ? "" : "-",
                     scene.objective);
}

std::vector<Case> load_cases(const Suite& suite, const std::string& filter) {
  const std::regex wanted = checked_regex(filter);
  check_scene_names(suite);
  std::vector<Case> cases;
  std::set<std::string> folders;
  for (const std::string& name : suite.scenes)
    for (const auto& spheres : suite.spheres) {
      Case item{load_scene(name, spheres), {}};
      if (!folders.insert(folder_name(item.scene)).second)
        throw Error("{}: scene '{}' has {} spheres{}{} twice; allowed are choices of spheres that differ",
                    suite.spheres_where, item.scene.name, item.scene.spheres.size(),
                    item.scene.objective.empty() ? "" : " for ", item.scene.objective);
      for (const Variant& variant : suite.variants)
        if (std::regex_search(row_of(item.scene, variant).name(), wanted)) item.variants.push_back(variant);
      if (!item.variants.empty()) cases.push_back(std::move(item));
    }
  if (cases.empty()) throw Error("--filter '{}' leaves nothing of suite '{}'", filter, suite.name);
  return cases;
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

/// Measures what is not finished yet. Whatever is thrown for the scene as a whole is the failure of its rows.
std::vector<Row> measure_case(Case& item, const Suite& suite, const Registry& registry, const RunOptions& options,
                              const std::vector<Row>& earlier, int repetitions, Progress& progress) {
  std::vector<Row> rows;
  try {
    SceneRun run(item.scene, registry, suite, options.directory + "/images/" + folder_name(item.scene));
    rows = take_finished(earlier, run, item.variants);
    if (item.variants.empty()) return rows;
    run.make_references(item.variants, progress);
    if (suite.baseline) run.make_baseline(*suite.baseline, progress);
    if (suite.sequence) run.make_sequence(progress);
    const std::vector<Row> measured = run.measure(item.variants, repetitions, progress);
    rows.insert(rows.end(), measured.begin(), measured.end());
  } catch (const std::exception& e) {
    progress.note(fmt::format("scene {}: failed: {}", item.scene.name, e.what()));
    for (const Variant& variant : item.variants) {
      rows.push_back(row_of(item.scene, variant));
      rows.back().status = std::string("failed: ") + e.what();
    }
  }
  return rows;
}

/// Rows of an earlier run that belong to scenes from `next` on: they stay on disk until their turn comes.
std::vector<Row> not_reached(const std::vector<Row>& earlier, const std::vector<Case>& cases, std::size_t next) {
  std::set<std::string> names;
  for (std::size_t k = next; k < cases.size(); ++k)
    for (const Variant& variant : cases[k].variants) names.insert(row_of(cases[k].scene, variant).name());
  std::vector<Row> rows;
  for (const Row& row : earlier)
    if (names.contains(row.name())) rows.push_back(row);
  return rows;
}

std::string make_tables(const Suite& suite, const std::optional<PublishedTable>& published,
                        const std::vector<Row>& rows) {
  const std::string text = make_table(rows) + make_choice_table(rows) +
                           (suite.baseline ? make_baseline_table(suite.baseline->entry->name, rows) : "") +
                           make_stages_table(rows) + make_sequence_table(rows) + make_steps_table(rows) +
                           make_counters_table(rows);
  if (suite.published_times.empty()) return text + (published ? make_published_table(*published, rows) : "");
  return text + make_published_times_table(suite, rows);
}

/// Empty, or why the files could not be written: a full disk must not end a run.
std::string failure_to_write(const std::string& directory, const nlohmann::json& context, const std::vector<Row>& rows,
                             const std::vector<Row>& waiting, const std::string& tables) {
  try {
    std::vector<Row> all = rows;
    all.insert(all.end(), waiting.begin(), waiting.end());
    write_results(directory, context, all);
    write_atomically(directory + "/table.md", tables);
    return "";
  } catch (const std::exception& e) {
    return e.what();
  }
}

}  // namespace

int run_suite(const Suite& suite, const Registry& registry, const RunOptions& options) {
  const auto published = suite.published.empty() || !suite.published_times.empty()
                             ? std::optional<PublishedTable>()
                             : PublishedTable::load(suite.published);
  if (!suite.published_times.empty()) check_published_times(suite);
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
  std::string unwritten;
  {
    Progress progress(steps);
    for (std::size_t k = 0; k < cases.size() && !interrupted(); ++k) {
      const std::vector<Row> more = measure_case(cases[k], suite, registry, options, earlier, repetitions, progress);
      rows.insert(rows.end(), more.begin(), more.end());
      unwritten = failure_to_write(options.directory, context, rows, not_reached(earlier, cases, k + 1),
                                   make_tables(suite, published, rows));
      if (!unwritten.empty()) progress.note(unwritten + "; going on, the tables come at the end");
    }
  }
  fmt::print("{}", make_tables(suite, published, rows));
  if (!unwritten.empty()) fmt::print(stderr, "the results are not on disk: {}\n", unwritten);
  if (interrupted()) {
    fmt::print(stderr, "interrupted: {} finished rows are in {}/results.json; --resume goes on\n", rows.size(),
               options.directory);
    return 130;
  }
  const auto failed = [](const Row& r) { return r.status.starts_with("failed"); };
  return !unwritten.empty() || std::any_of(rows.begin(), rows.end(), failed) ? 1 : 0;
}

}  // namespace penumbra
