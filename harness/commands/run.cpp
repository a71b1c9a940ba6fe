#include "harness/commands/run.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <thread>

#include "harness/measure/execute.h"
#include "harness/measure/interrupt.h"
#include "harness/measure/timing.h"
#include "harness/report/published.h"
#include "harness/report/published_times.h"
#include "harness/report/run_screen.h"
#include "harness/report/screen.h"
#include "harness/report/sheet.h"
#include "harness/report/tables.h"
#include "harness/results/provenance.h"
#include "scenes/log.h"
#include "scenes/storage/atomic_write.h"

namespace penumbra {
namespace {

/// All tables of a run.
class Tables {
 public:
  /// Throws Error if the published figures of the suite are not there.
  explicit Tables(const Suite& suite) : suite_(suite) {
    if (!suite.published_times.empty()) check_published_times(published_times());
    else if (!suite.published.empty()) published_ = PublishedTable::load(suite.published);
  }

  std::string of(const std::vector<Row>& rows) const {
    return make_table(rows) + make_choice_table(rows) +
           (suite_.baseline ? make_baseline_table(suite_.baseline->entry->name, rows) : "") + make_stages_table(rows) +
           make_sequence_table(rows) + make_steps_table(rows) + make_counters_table(rows) + make_external_table(rows) +
           (published_ ? make_published_table(*published_, rows) : "") +
           (suite_.published_times.empty() ? "" : make_published_times_table(published_times(), rows));
  }

 private:
  PublishedTimes published_times() const { return {suite_.name, suite_.published, suite_.published_times}; }

  const Suite& suite_;
  std::optional<PublishedTable> published_;
};

/// Writes rows and tables. Empty, or why that failed.
std::string save(ResultsFolder& folder, const Tables& tables) {
  if (std::string why = folder.save(); !why.empty()) return why;
  try {
    const std::vector<Row> rows = folder.all_rows();
    write_atomically(folder.directory() + "/table.md", make_heading(folder.context(), rows) + tables.of(rows));
    return "";
  } catch (const std::exception& e) {
    return e.what();
  }
}

void warn_of_threads(const Plan& plan) {
  const int cores = int(std::thread::hardware_concurrency());
  int most = 0;
  for (const PlannedScene& scene : plan.scenes)
    for (const Job& job : scene.jobs)
      if (job.kind == Job::Kind::measurement) most = std::max(most, plan.suite->variants[job.variant].threads);
  if (most > cores)
    warn("some rows ask for {} threads, and this machine has {} cores: their times are of threads that wait", most,
         cores);
}

void warn_of_load(const nlohmann::json& context) {
  if (context.at("busy").get<bool>())
    warn("this machine is busy: its load is {:.1f} on {} cores; times are marked so in results.json",
         context.at("load_avg").at(0).get<double>(), context.at("num_cpus").get<int>());
}

/// Scene and variant of everything that a suite measures, whatever a filter leaves of it.
std::set<std::string> all_of(const Suite& suite) {
  std::set<std::string> names;
  const Plan whole = make_plan(suite, ".*", 0);
  for (const PlannedScene& scene : whole.scenes)
    for (const Variant& variant : suite.variants)
      names.insert(scene.outline.name + "/" + identity_of(scene.outline, variant).variant());
  return names;
}

/// Rows of an earlier run of the suite, and of images that were scored beside it, that may stand under today's context,
/// which keeps the mark of a busy machine. Of scenes in `keys`, only those whose truth is still the same. Says why if
/// there are none.
std::vector<Row> comparable_rows(const std::string& directory, const Suite& suite,
                                 const std::map<std::string, std::string>& keys, nlohmann::json& context) {
  Results earlier = read_results(directory);
  const std::string why = difference(earlier.context, context);
  if (earlier.rows.empty()) return {};
  if (why.empty()) {
    const std::set<std::string> known = all_of(suite);
    std::erase_if(earlier.rows, [&](const Row& row) {
      const auto at = keys.find(row.id.scene);
      const bool wanted =
          (row.id.external() && row.timing.command_ms < 0.0) || known.contains(row.id.scene + "/" + row.id.variant());
      return !row.ok() || !wanted || (at != keys.end() && !row.facts.scene_key.starts_with(at->second));
    });
    if (earlier.context.value("busy", false)) context["busy"] = true;
    return earlier.rows;
  }
  warn("{}/results.json: none of its {} rows is kept, all is measured again: {}", directory, earlier.rows.size(), why);
  return {};
}

std::string all_skipped_because(const std::vector<Row>& rows) {
  std::set<std::string> reasons;
  for (const Row& row : rows) {
    if (!row.skipped()) return "";
    reasons.insert(row.status.substr(std::string("skipped: ").size()));
  }
  return fmt::format("{}", fmt::join(reasons, "; "));
}

void say_what_is_kept(const ResultsFolder& folder) {
  const std::vector<Row> rows = folder.all_rows();
  say(fmt::format("interrupted: {} finished rows are in {}/results.json; --resume goes on\n",
                  std::count_if(rows.begin(), rows.end(), [](const Row& row) { return row.ok(); }),
                  folder.directory()));
}

/// One screen; all tables if they are not on disk.
std::string last_words(const ResultsFolder& folder, const Tables& tables, const RunSummary& summary, bool written) {
  if (!written) return tables.of(folder.all_rows());
  return make_run_screen(summary, folder.all_rows(), screen_width());
}

RunSummary summary_of(const Suite& suite, const ResultsFolder& folder, const nlohmann::json& context, double seconds) {
  return {suite.name, folder.directory(),
          fmt::format("{} cores of {}", context.at("num_cpus").get<int>(), context.value("cpu_name", "an unknown CPU")),
          seconds};
}

int finish(ResultsFolder& folder, const Tables& tables, const RunSummary& summary) {
  const std::string unwritten = save(folder, tables);
  std::fputs(last_words(folder, tables, summary, unwritten.empty()).c_str(), stdout);
  const bool unprinted = std::fflush(stdout) != 0;
  if (unprinted) say(fmt::format("the tables could not be printed; they are in {}/table.md\n", folder.directory()));
  if (!unwritten.empty()) say(fmt::format("the results are not on disk: {}\n", unwritten));
  if (interrupted()) {
    say_what_is_kept(folder);
    return 130;
  }
  const std::vector<Row> rows = folder.rows();
  const std::string skipped = all_skipped_because(rows);
  if (!skipped.empty()) say(fmt::format("nothing was measured, every row was skipped: {}\n", skipped));
  const bool failed = std::any_of(rows.begin(), rows.end(), [](const Row& row) { return row.failed(); });
  if (rows.empty()) say("nothing was measured\n");
  return unprinted || !unwritten.empty() || !skipped.empty() || failed || rows.empty() ? 1 : 0;
}

}  // namespace

int run_suite(const Suite& suite, const Registry& registry, const RunOptions& options) {
  const auto start = std::chrono::steady_clock::now();
  const Tables tables(suite);
  const Plan plan = make_plan(suite, options.filter, options.repetitions);
  const std::map<std::string, std::string> keys = check_scenes(plan);
  nlohmann::json context = machine_context(registry);
  context["suite"] = suite.name;
  if (!suite.published.empty()) context["published"] = suite.published;
  if (!suite.published_times.empty()) context["published_times"] = to_json(suite.published_times);
  ResultsFolder folder(options.directory);
  warn_of_threads(plan);
  warn_of_load(context);  // of now: rows that are kept may bring the mark of an earlier load
  const std::vector<Row> earlier =
      options.resume ? comparable_rows(options.directory, suite, keys, context) : std::vector<Row>();
  folder.begin(context, earlier);
  {
    const InterruptWatch watch([] { say("\nstopping; what is finished is kept (once more: stop at once)\n"); },
                               [&] {
                                 save(folder, tables);
                                 say_what_is_kept(folder);
                               });
    const std::size_t kept = execute(plan, registry, earlier, folder, [&](const std::string& images, bool changed) {
      const std::string& to = options.directory;
      if (changed || !std::filesystem::exists(to + "/" + images + "/overview.png"))
        save_overview(to, images, folder.all_rows());
    });
    if (!earlier.empty()) inform("{} of {} rows of the earlier run were kept", kept, earlier.size());
  }
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return finish(folder, tables, summary_of(suite, folder, context, seconds));
}

}  // namespace penumbra
