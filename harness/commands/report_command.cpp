// penumbra report: one page of a run, made by scripts/report in Python from the rows and the figures derived here.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>

#include "harness/catalogue/catalogue.h"
#include "harness/commands/commands.h"
#include "harness/commands/page_script.h"
#include "harness/compare/comparison.h"
#include "harness/measure/child_process.h"
#include "harness/measure/interrupt.h"
#include "harness/measure/progress.h"
#include "harness/report/comparison_text.h"
#include "harness/report/figures.h"
#include "scenes/error.h"
#include "scenes/storage/atomic_write.h"

namespace penumbra {
namespace {

namespace fs = std::filesystem;

struct ReportOptions {
  std::string run, page, base, paper;
  std::vector<std::string> history;
  bool open = false, figures = false;
};

std::string file_of(const std::string& file_or_folder) {
  const std::string path = file_or_folder.starts_with('-') ? "./" + file_or_folder : file_or_folder;  // no option
  return fs::is_directory(path) ? (fs::path(path) / "results.json").string() : path;
}

/// What is no UTF-8 is replaced.
std::string text_of(const nlohmann::json& document) {
  return document.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
}

/// What follows from the rows, and whom their techniques go back to.
nlohmann::json figures_of(const Results& results) {
  nlohmann::json figures = make_figures(results);
  const Registry registry = make_registry();
  for (const Entry& entry : registry.entries()) figures["citations"][entry.name] = entry.citation;
  return figures;
}

/// A folder that is gone in the end.
class PassingFolder {
 public:
  PassingFolder() : path_((fs::temp_directory_path() / "penumbra-report-XXXXXX").string()) {
    if (!mkdtemp(path_.data())) throw Error("{}: no temporary folder", path_);
  }
  ~PassingFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  PassingFolder(const PassingFolder&) = delete;
  PassingFolder& operator=(const PassingFolder&) = delete;
  const std::string& path() const { return path_; }

 private:
  std::string path_;
};

/// Writes what the script reads, and returns the words that name it.
std::vector<std::string> arguments_for(const ReportOptions& options, const std::string& page,
                                       const std::string& folder) {
  const Results results = read_results_path(options.run);
  write_atomically(folder + "/figures.json", text_of(figures_of(results)));
  std::vector<std::string> words = {"--results", file_of(options.run), "--figures", folder + "/figures.json", "--out",
                                    page};
  if (!options.base.empty()) {
    const Results base = read_results_path(options.base);
    const Comparison comparison = compare(base, results, {});
    if (comparison.rows.empty())
      throw Error("{} and {} have no row in common; compare runs of one suite", options.base, options.run);
    write_atomically(folder + "/comparison.json", text_of(comparison_json(comparison)));
    words.insert(words.end(), {"--base", file_of(options.base), "--comparison", folder + "/comparison.json"});
  }
  if (!options.history.empty()) words.emplace_back("--history");
  for (const std::string& run : options.history) {
    read_results_path(run);  // throws where there is none
    words.push_back(file_of(run));
  }
  if (!options.paper.empty()) words.insert(words.end(), {"--paper", options.paper});
  return words;
}

/// The browser outlives this program: it gets a session of its own, and is in it before this command ends.
void open_page(const std::string& page) {
  const CommandEnd end = run_command(
      "command -v xdg-open >/dev/null || exit 127; "
      "setsid --fork sh -c 'echo there; exec xdg-open \"$0\" >/dev/null' " +
          shell_word(page) + " </dev/null 2>/dev/null | read there",
      ".", 10.0, [](std::string_view) {});
  if (!end.fault().empty()) say("the page cannot be opened: there is no xdg-open (package xdg-utils)\n");
}

int make_page(const ReportOptions& options) {
  const std::string page =
      !options.page.empty() ? options.page : (fs::path(file_of(options.run)).parent_path() / "report.html").string();
  const PassingFolder folder;
  const std::vector<std::string> words = arguments_for(options, page, folder.path());
  const InterruptWatch watch([] { say("\nstopping\n"); }, [] {});
  try {
    if (const int code = run_page_script(words); code != 0) return code;
  } catch (const Interrupted&) {
    return 130;
  }
  if (options.open) open_page(page);
  fmt::print("{}\n", page);
  return 0;
}

}  // namespace

void add_report(CLI::App& app, int& exit_code) {
  auto* command = app.add_subcommand("report", "Make a page of a run, to look at and to choose from");
  static ReportOptions options;
  command->add_option("results", options.run, "Folder of results or its results.json")->required();
  auto* open = command->add_flag("--open", options.open, "Show the page in the browser");
  auto* page = command->add_option("--out", options.page, "Page to write (default: report.html in the folder)");
  auto* base = command->add_option("--compare", options.base, "Earlier results, which the page holds these against");
  auto* paper = command->add_option("--paper", options.paper, "Folder for plots and tables that a paper can include");
  auto* history = command->add_option("--history", options.history, "Earlier results of the same machine");
  auto* figures = command->add_flag("--figures", options.figures, "Make no page; print what follows from the rows");
  for (CLI::Option* other : {open, page, base, paper, history}) figures->excludes(other);
  command->callback([&exit_code] {
    if (options.figures) fmt::print("{}", text_of(figures_of(read_results_path(options.run))));
    else exit_code = make_page(options);
  });
}

}  // namespace penumbra
