#include <filesystem>

#include "harness/report/comparison_text.h"
#include "harness/results/lettering.h"
#include "harness/results/metrics.h"
#include "harness/results/pictures.h"
#include "scenes/names.h"

namespace penumbra {
namespace {

/// Empty if there is no such image.
Image image_of(const std::string& folder, const Row& row) {
  const std::string file = folder + "/" + row.facts.image + ".exr";
  return row.facts.image.empty() || !std::filesystem::exists(file) ? Image() : load_image(file);
}

/// Base, new and their difference, under what they are.
Image side_by_side(const Image& base, const Image& next, const Lettering& lettering) {
  constexpr int widest = 512, gap = 8, letters = 13, caption = 20;
  const double exposure = exposure_for(base, std::vector<bool>(base.pixels.size(), true));
  const Image panels[] = {panel(exposed(base, exposure), widest), panel(exposed(next, exposure), widest),
                          panel(signed_error(next, base, exposure), widest)};
  const char* captions[] = {"base", "new", "new - base: red brighter, blue darker"};
  const int step = panels[0].width + gap;
  Image sheet{3 * step - gap, caption + panels[0].height, {}};
  sheet.pixels.assign(std::size_t(sheet.width) * sheet.height, vec3(1.0f));
  for (int k = 0; k < 3; ++k) {
    lettering.draw(lettering.fitted(captions[k], panels[0].width, letters), k * step, caption - 6, letters, sheet);
    paste(panels[k], k * step, caption, sheet);
  }
  return sheet;
}

}  // namespace

std::vector<std::string> save_comparison_pictures(const Comparison& comparison, const std::string& base,
                                                  const std::string& next, const std::string& folder) {
  constexpr std::size_t most = 20;
  const Lettering lettering;
  std::vector<std::string> files;
  for (const ComparedRow& row : comparison.rows) {
    using Verdict = ErrorComparison::Verdict;
    if (files.size() == most || (row.error.verdict != Verdict::worse && row.error.verdict != Verdict::better)) continue;
    try_to_save([&] {
      const Image before = image_of(base, *row.base), now = image_of(next, *row.next);
      if (before.pixels.empty() || before.width != now.width || before.height != now.height) return;
      std::filesystem::create_directories(folder);
      const std::string file = folder + "/" + file_name(row.name) + ".png";
      save_png(file, side_by_side(before, now, lettering));
      files.push_back(file);
    });
  }
  return files;
}

}  // namespace penumbra
