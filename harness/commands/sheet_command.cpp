// penumbra sheet: rows of a run side by side, as a picture with labels.
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>

#include "harness/commands/commands.h"
#include "harness/report/row_text.h"
#include "harness/report/sheet.h"
#include "harness/results/results_file.h"
#include "scenes/error.h"

namespace penumbra {
namespace {

struct SheetOptions {
  std::string folder, output;
  std::vector<std::string> scenes, rows;
  int columns = 6;
};

/// Rows with an image on a scene: of every regular expression those that it is found in, in order of frame time.
std::vector<const Row*> chosen(const std::vector<const Row*>& good, const std::vector<std::string>& expressions) {
  std::vector<const Row*> sorted = good, rows;
  std::stable_sort(sorted.begin(), sorted.end(), [](const Row* a, const Row* b) {
    return a->timing.median_frame_ms() < b->timing.median_frame_ms();
  });
  for (const std::string& text : expressions) {
    const Pattern wanted("--rows", text);
    const std::size_t before = rows.size();
    for (const Row* row : sorted)
      if (is_in(wanted, row->id)) rows.push_back(row);
    if (rows.size() == before)
      throw Error("--rows '{}' is found in no measured row of scene '{}'; see the names in results.json", text,
                  good.front()->id.scene);
  }
  return rows;
}

void check_images(const std::string& folder, const std::vector<const Row*>& rows) {
  for (const Row* row : rows) {
    if (row->facts.image.empty())
      throw Error("{}/results.json: row '{}' does not say where its image is; measure it again", folder,
                  row->id.name());
    const std::string file = folder + "/" + row->facts.image + ".png";
    if (!std::filesystem::exists(file))
      throw Error("{}: the image of row '{}' is missing; measure it again", file, row->id.name());
  }
}

void sheet(const SheetOptions& options) {
  if (!options.output.ends_with(".png")) throw Error("-o {}: the name must end in .png", options.output);
  if (!std::filesystem::exists(options.folder + "/results.json"))
    throw Error("{}: no folder of results: there is no results.json in it", options.folder);
  const Results results = read_results(options.folder);
  const std::vector<std::string> known = scenes_of(results.rows);
  std::vector<std::vector<const Row*>> parts;
  for (const std::string& scene : options.scenes.empty() ? known : options.scenes) {
    const std::vector<const Row*> good = good_rows(results.rows, scene);
    if (good.empty())
      throw Error("{}: no measured row of scene '{}'; there are {}", options.folder, scene,
                  fmt::format("{}", fmt::join(known, ", ")));
    parts.push_back(chosen(good, options.rows.empty() ? std::vector<std::string>{".*"} : options.rows));
    check_images(options.folder, parts.back());
  }
  const Image image = draw_sheet(options.folder, parts, options.columns);
  if (image.pixels.empty()) throw Error("{}: none of these rows has a picture", options.folder);
  save_png(options.output, image);
  fmt::print("{}: {} x {} pixels\n", options.output, image.width, image.height);
}

}  // namespace

void add_sheet(CLI::App& app, int&) {
  auto* command = app.add_subcommand("sheet", "Lay out rows of a run side by side, with labels and signed errors");
  static SheetOptions options;
  command->add_option("folder", options.folder, "Folder of results")->required();
  command->add_option("--scene", options.scenes, "Which scenes, one above the other (default: all)")
      ->allow_extra_args(false);
  command->add_option("--rows", options.rows, "Regular expressions searched in row names, in order (default: all rows)")
      ->allow_extra_args(false);
  command->add_option("--columns", options.columns, "Panels side by side, the truth among them")
      ->check(CLI::Range(1, 100))
      ->default_val(options.columns);
  command->add_option("-o", options.output, "Image: .png")->required();
  command->callback([] { sheet(options); });
}

}  // namespace penumbra
