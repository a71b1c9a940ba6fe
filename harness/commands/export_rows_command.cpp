// penumbra export-rows: results for spreadsheets, papers and services that watch benchmarks.
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>

#include "harness/commands/commands.h"
#include "harness/report/formats/formats.h"
#include "scenes/error.h"
#include "scenes/log.h"
#include "scenes/storage/atomic_write.h"

namespace penumbra {
namespace {

struct ExportRowsOptions {
  std::vector<std::string> results;
  std::string format, output;
};

const ExportFormat& format_named(const std::string& name) {
  std::vector<std::string> names;
  for (const ExportFormat& format : export_formats()) {
    if (format.name == name) return format;
    names.emplace_back(format.name);
  }
  throw Error("--format {}: no such format; allowed are {}", name, fmt::join(names, ", "));
}

Exported exported(const ExportFormat& format, const std::vector<std::string>& paths) {
  std::vector<Results> runs;
  runs.reserve(paths.size());
  for (const std::string& path : paths) runs.push_back(read_results_path(path));
  try {
    return format.write(runs);
  } catch (const Error& e) {
    throw Error("{}: {}", fmt::join(paths, ", "), e.what());
  }
}

void export_rows(const ExportRowsOptions& options) {
  const ExportFormat& format = format_named(options.format);
  if (options.results.size() > 1 && !format.several)
    throw Error("--format {} takes one run, and {} are given", format.name, options.results.size());
  const Exported out = exported(format, options.results);
  if (options.output.empty()) fmt::print("{}", out.text);
  else write_atomically(options.output, out.text);
  if (!out.left_out.empty()) warn("{}: left out: {}", fmt::join(options.results, ", "), out.left_out);
}

std::string formats_text() {
  std::vector<std::string> lines;
  for (const ExportFormat& format : export_formats())
    lines.push_back(fmt::format("{}: {}", format.name, format.summary));
  return fmt::format("{}", fmt::join(lines, "; "));
}

}  // namespace

void add_export_rows(CLI::App& app, int&) {
  auto* command = app.add_subcommand("export-rows", "Write the rows of a run in a format that another tool reads");
  static ExportRowsOptions options;
  command->add_option("results", options.results, "Folder of results or its results.json; several for otava")
      ->required();
  command->add_option("--format", options.format, formats_text())->required();
  command->add_option("--out", options.output, "File to write to (default: the screen)");
  command->callback([] { export_rows(options); });
}

}  // namespace penumbra
