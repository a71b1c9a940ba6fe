#include "harness/commands/run.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <optional>
#include <set>
#include <thread>

#include "harness/measure/execute.h"
#include "harness/measure/interrupt.h"
#include "harness/measure/timing.h"
#include "harness/report/published.h"
#include "harness/report/published_times.h"
#include "harness/report/tables.h"
#include "harness/results/provenance.h"

namespace penumbra {
namespace {

/// All tables of a run.
class Tables {
 public:
  /// Throws Error if the published figures of the suite are not there.
  explicit Tables(const Suite& suite) : suite_(suite) {
    if (!suite.published_times.empty()) check_published_times(suite);
    else if (!suite.published.empty()) published_ = PublishedTable::load(suite.published);
  }

  std::string of(const std::vector<Row>& rows) const {
    return make_table(rows) + make_choice_table(rows) +
           (suite_.baseline ? make_baseline_table(suite_.baseline->entry->name, rows) : "") + make_stages_table(rows) +
           make_sequence_table(rows) + make_steps_table(rows) + make_counters_table(rows) +
           (published_ ? make_published_table(*published_, rows) : "") +
           (suite_.published_times.empty() ? "" : make_published_times_table(suite_, rows));
  }

 private:
  const Suite& suite_;
  std::optional<PublishedTable> published_;
};

/// Writes rows and tables. Empty, or why that failed.
std::string save(ResultsFolder& folder, const Tables& tables, bool over) {
  if (std::string why = folder.save(over); !why.empty()) return why;
  try {
    write_atomically(folder.directory() + "/table.md", tables.of(folder.rows()));
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
    spdlog::warn("some rows ask for {} threads, and this machine has {} cores: their times are of threads that wait",
                 most, cores);
}

void warn_of_load(const nlohmann::json& context) {
  if (context.at("busy").get<bool>())
    spdlog::warn("this machine is busy: its load is {:.1f} on {} cores; times are marked so in results.json",
                 context.at("load_avg").at(0).get<double>(), context.at("num_cpus").get<int>());
}

/// Rows of an earlier run that may stand under today's context. Says why if there are none.
std::vector<Row> comparable_rows(const std::string& directory, const nlohmann::json& context) {
  Results earlier = read_results(directory);
  if (earlier.rows.empty()) return {};
  const std::string why = difference(earlier.context, context);
  if (why.empty()) return earlier.rows;
  spdlog::warn("{}/results.json: none of its {} rows is kept, all is measured again: {}", directory,
               earlier.rows.size(), why);
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

int finish(ResultsFolder& folder, const Tables& tables) {
  const bool stopped = interrupted();
  const std::string unwritten = save(folder, tables, !stopped);
  const std::vector<Row> rows = folder.rows();
  fmt::print("{}", tables.of(rows));
  if (!unwritten.empty()) fmt::print(stderr, "the results are not on disk: {}\n", unwritten);
  if (stopped) {
    fmt::print(stderr, "interrupted: {} finished rows are in {}/results.json; --resume goes on\n", rows.size(),
               folder.directory());
    return 130;
  }
  const std::string skipped = all_skipped_because(rows);
  if (!skipped.empty()) fmt::print(stderr, "nothing was measured, every row was skipped: {}\n", skipped);
  const bool failed = std::any_of(rows.begin(), rows.end(), [](const Row& row) { return row.failed(); });
  return !unwritten.empty() || !skipped.empty() || failed ? 1 : 0;
}

}  // namespace

int run_suite(const Suite& suite, const Registry& registry, const RunOptions& options) {
  const Tables tables(suite);
  const Plan plan = make_plan(suite, options.filter, options.repetitions);
  check_scenes(plan);
  nlohmann::json context = machine_context();
  context["suite"] = suite.name;
  ResultsFolder folder(options.directory);
  const std::vector<Row> earlier = options.resume ? comparable_rows(options.directory, context) : std::vector<Row>();
  warn_of_threads(plan);
  warn_of_load(context);
  folder.begin(context, earlier);
  {
    const InterruptWatch watch(
        [] { fmt::print(stderr, "\nstopping; what is finished is kept (once more: stop at once)\n"); },
        [&] {
          save(folder, tables, false);
          fmt::print(stderr, "interrupted: {} finished rows are in {}/results.json; --resume goes on\n",
                     folder.rows().size(), folder.directory());
        });
    const std::size_t kept = execute(plan, registry, earlier, folder);
    if (!earlier.empty()) spdlog::info("{} of {} rows of the earlier run were kept", kept, earlier.size());
  }
  return finish(folder, tables);
}

}  // namespace penumbra
