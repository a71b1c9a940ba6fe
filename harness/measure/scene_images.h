// The images that a run leaves of one scene: each variant's.
#pragma once

#include "harness/measure/scene_context.h"

namespace penumbra {

/// Writes images; one that cannot be written is a warning. The context outlives this.
class SceneImages {
 public:
  /// `results`: the folder of a run; images go to images/ below it.
  SceneImages(const Suite& suite, const std::string& results, const SceneContext& context);

  /// Where the images are, below the folder of results.
  const std::string& folder() const { return folder_; }
  /// A variant's image file without its ending, below the folder of results.
  std::string stem(const Variant& variant) const { return folder_ + "/" + stems_.at(variant.label()); }

  /// Where the contact sheet of a variant's frames belongs.
  std::string sheet_file(const Variant& variant) const;
  void save_truth();
  /// Writes STEM.exr and .png, and the error: STEM.error.exr (image - truth) and .error.png (signed, in colours).
  void save(const Variant& variant, const Image& image);

 private:
  void save_both(const std::string& stem, const Image& image) const;

  const std::map<std::string, std::string> stems_;  ///< by label
  const std::string results_, folder_;
  const SceneContext& context_;
};

}  // namespace penumbra
