#include "harness/measure/scene_images.h"

#include <algorithm>

#include "harness/measure/file_stems.h"
#include "harness/results/metrics.h"
#include "harness/results/pictures.h"

namespace penumbra {

SceneImages::SceneImages(const Suite& suite, std::string folder, const SceneContext& context)
    : stems_(file_stems(suite.variants)), folder_(std::move(folder)), context_(context) {}

std::string SceneImages::sheet_file(const Variant& variant) const {
  return file(stems_.at(variant.label())) + ".sheet.png";
}

void SceneImages::save_both(const std::string& stem, const Image& image) const {
  try_to_save([&] {
    save_exr(file(stem) + ".exr", image);
    save_png(file(stem) + ".png", exposed(image, context_.exposure()));
  });
}

void SceneImages::save_truth() {
  save_both("truth", context_.truth());
  panels_ = errors_ = {thumbnail(exposed(context_.truth(), context_.exposure()))};
}

void SceneImages::save(const Variant& variant, const Image& image) {
  const std::string stem = stems_.at(variant.label());
  save_both(stem, image);
  const Image error = signed_error(image, context_.truth(), context_.exposure());
  try_to_save([&] {
    save_exr(file(stem) + ".error.exr", difference(image, context_.truth()));
    save_png(file(stem) + ".error.png", error);
  });
  if (image.height == 1) return;  // vertices make no picture
  panels_.push_back(thumbnail(exposed(image, context_.exposure())));
  errors_.push_back(thumbnail(error));
}

void SceneImages::save_overview() const {
  constexpr std::size_t columns = 6;
  if (panels_.size() < 2) return;
  std::vector<std::vector<Image>> rows;
  for (std::size_t k = 0; k < panels_.size(); k += columns)
    for (const std::vector<Image>* from : {&panels_, &errors_})
      rows.emplace_back(from->begin() + std::ptrdiff_t(k),
                        from->begin() + std::ptrdiff_t(std::min(panels_.size(), k + columns)));
  try_to_save([&] { save_png(folder_ + "/overview.png", contact_sheet(rows)); });
}

}  // namespace penumbra
