#include "harness/measure/scene_images.h"

#include "harness/measure/file_stems.h"
#include "harness/results/metrics.h"
#include "harness/results/pictures.h"

namespace penumbra {

SceneImages::SceneImages(const Suite& suite, const std::string& results, const SceneContext& context)
    : stems_(file_stems(suite.variants)), results_(results), folder_("images/" + context.folder()), context_(context) {}

std::string SceneImages::sheet_file(const Variant& variant) const {
  return results_ + "/" + stem(variant) + ".sheet.png";
}

void SceneImages::save_both(const std::string& stem, const Image& image) const {
  try_to_save([&] {
    save_exr(results_ + "/" + stem + ".exr", image);
    save_png(results_ + "/" + stem + ".png", exposed(image, context_.exposure()));
  });
}

void SceneImages::save_truth() {
  save_both(folder_ + "/truth", context_.truth());
}

void SceneImages::save(const Variant& variant, const Image& image) {
  save_both(stem(variant), image);
  const Image error = signed_error(image, context_.truth(), context_.exposure());
  try_to_save([&] {
    save_exr(results_ + "/" + stem(variant) + ".error.exr", difference(image, context_.truth()));
    save_png(results_ + "/" + stem(variant) + ".error.png", error);
  });
}

}  // namespace penumbra
