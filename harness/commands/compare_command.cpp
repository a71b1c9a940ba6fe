// penumbra compare: two runs, or two programs, row by row.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <charconv>
#include <cmath>

#include "harness/catalogue/catalogue.h"
#include "harness/commands/commands.h"
#include "harness/measure/interrupt.h"
#include "harness/measure/side_by_side/side_by_side.h"
#include "harness/report/comparison_text.h"
#include "harness/report/screen.h"
#include "scenes/error.h"
#include "scenes/storage/atomic_write.h"

namespace penumbra {
namespace {

struct CompareOptions {
  std::vector<std::string> inputs;
  bool ab = false, json = false, markdown = false;
  std::string slower = "5%", error = "5%";
  std::string pictures;
  SideBySide plan;
};

/// "5%" or "0.05".
double share_of(const char* option, const std::string& text) {
  double value = 0.0;
  const char* end = text.data() + text.size();
  const auto [at, fault] = std::from_chars(text.data(), end, value);
  const std::string unit(at, end);
  if (unit == "%") value /= 100.0;
  if (fault != std::errc() || (!unit.empty() && unit != "%") || !(value >= 0.0 && value <= 10.0) ||
      (unit.empty() && value >= 1.0))
    throw Error("{} {}: allowed is 0% to 1000%, such as 5%, or a share below 1 without a sign, such as 0.05", option,
                text);
  return value;
}

void print(const CompareOptions& options, const Comparison& comparison) {
  if (options.json)
    fmt::print("{}\n", comparison_json(comparison).dump(1, ' ', false, nlohmann::json::error_handler_t::replace));
  else
    fmt::print("{}", options.markdown ? make_comparison_markdown(comparison)
                                      : make_comparison_screen(comparison, screen_width()));
}

int finish(const CompareOptions& options, const Comparison& comparison, const std::string& pictures_of_base,
           const std::string& pictures_of_next, const std::string& pictures) {
  if (comparison.rows.empty() && comparison.unmeasured == 0)
    throw Error("the two have no row in common: {} rows are in base alone, {} in new alone; compare runs of one suite",
                comparison.removed.size(), comparison.added.size());
  print(options, comparison);
  if (pictures.empty()) return comparison.exit_code();
  const auto files = save_comparison_pictures(comparison, pictures_of_base, pictures_of_next, pictures);
  const auto changed = std::count_if(comparison.rows.begin(), comparison.rows.end(), [](const ComparedRow& row) {
    using Verdict = ErrorComparison::Verdict;
    return row.error.verdict == Verdict::worse || row.error.verdict == Verdict::better;
  });
  if (changed > 0)
    say(fmt::format("{} picture{} of {} changed error{}: {}{}\n", files.size(), files.size() == 1 ? "" : "s", changed,
                    changed == 1 ? "" : "s", pictures,
                    files.empty() ? " (the images of both runs are not there)" : ""));
  return comparison.exit_code();
}

/// The folder of a results.json, or the folder itself.
std::string folder_of(const std::string& path) {
  if (std::filesystem::is_directory(path)) return path;
  const std::string parent = std::filesystem::path(path).parent_path().string();
  return parent.empty() ? "." : parent;
}

int compare_files(const CompareOptions& options) {
  if (options.inputs.size() != 2)
    throw Error("compare takes two runs, BASE and NEW (folders, or results.json files), and was given {}",
                options.inputs.size());
  const Results base = read_results_path(options.inputs[0]), next = read_results_path(options.inputs[1]);
  return finish(options, compare(base, next, options.plan.thresholds), folder_of(options.inputs[0]),
                folder_of(options.inputs[1]), options.pictures);
}

int compare_programs(CompareOptions& options) {
  if (options.inputs.size() != 3)
    throw Error("compare --ab takes two programs and a suite, BINARY_A BINARY_B SUITE, and was given {} words",
                options.inputs.size());
  SideBySide& plan = options.plan;
  plan.programs[0] = options.inputs[0], plan.programs[1] = options.inputs[1], plan.suite = options.inputs[2];
  const std::string saved = plan.directory;
  const InterruptWatch watch([&] { say(fmt::format("\nstopping; what is measured is in {}\n", saved)); }, [] {});
  TwoResults both;
  try {
    Progress progress;
    both = measure_side_by_side(plan, progress);
  } catch (const Interrupted&) {
    return 130;
  }
  const Comparison comparison = compare(both.base, both.next, plan.thresholds);
  write_atomically(saved + "/comparison.md", make_comparison_markdown(comparison));
  write_atomically(saved + "/comparison.json",
                   comparison_json(comparison).dump(1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n");
  const std::string pictures = options.pictures.empty() ? saved + "/changed" : options.pictures;
  return finish(options, comparison, saved + "/base", saved + "/new", pictures);
}

}  // namespace

void add_compare(CLI::App& app, int& exit_code) {
  auto* command = app.add_subcommand("compare", "Tell what two runs, or two programs, differ in: time and error");
  static CompareOptions options;
  SideBySide& plan = options.plan;
  command->add_option("inputs", options.inputs, "BASE NEW: results; with --ab BINARY_A BINARY_B SUITE")->required();
  auto* ab = command->add_flag("--ab", options.ab, "Measure two programs in turn, until every row is certain");
  command->add_option("--fail-slower", options.slower, "A row that takes longer by more than this is a regression")
      ->default_str("5%");
  command->add_option("--fail-error", options.error, "The same, for a growing error")->default_str("5%");
  auto* json = command->add_flag("--json", options.json, "Print every row as JSON");
  command->add_flag("--markdown", options.markdown, "Print Markdown for a pull request")->excludes(json);
  command->add_option("--pictures", options.pictures, "Folder for pictures of rows whose error changed");
  command->add_option("--budget", plan.budget_s, "Seconds to measure a row at most")
      ->default_val(20.0)
      ->check(CLI::Range(0.1, 1e5))
      ->needs(ab);
  command->add_option("--filter", plan.filter, "Regular expression searched in row names")->needs(ab);
  command->add_option("--threads", plan.threads, "Threads of parallel backends (default: the suite's)")
      ->check(CLI::Range(1, 1024))
      ->needs(ab);
  command->add_option("--out", plan.directory, "Folder for results of both")->default_val("results/runs/ab")->needs(ab);
  command->add_option("--seed", plan.seed, "Of the order of rows and programs")->default_val(1)->needs(ab);
  command->callback([&exit_code] {
    options.plan.thresholds = {share_of("--fail-slower", options.slower), share_of("--fail-error", options.error)};
    exit_code = options.ab ? compare_programs(options) : compare_files(options);
  });
}

}  // namespace penumbra
