// The images that a run leaves of one scene: each variant's, and all side by side.
#pragma once

#include "harness/measure/scene_context.h"

namespace penumbra {

/// What cannot be written is a warning. The context outlives this.
class SceneImages {
 public:
  SceneImages(const Suite& suite, std::string folder, const SceneContext& context);

  /// Where the contact sheet of a variant's frames belongs.
  std::string sheet_file(const Variant& variant) const;
  void save_truth();
  /// Where an image and its error lie: a path without `.exr` and the like.
  std::string stem(const Variant& variant) const { return file(stems_.at(variant.label())); }
  /// STEM.exr and .png, and its error: STEM.error.exr (image - truth) and .error.png (signed, in colours).
  void save(const Variant& variant, const Image& image);
  /// overview.png: truth and all variants, their signed errors below.
  void save_overview() const;

 private:
  std::string file(const std::string& stem) const { return folder_ + "/" + stem; }
  void save_both(const std::string& stem, const Image& image) const;

  const std::map<std::string, std::string> stems_;  ///< by label
  const std::string folder_;
  const SceneContext& context_;
  std::vector<Image> panels_, errors_;  ///< thumbnails
};

}  // namespace penumbra
