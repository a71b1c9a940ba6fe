// Has an external technique make its image, and scores it.
#pragma once

#include <optional>

#include "harness/measure/check.h"

namespace penumbra {

/// An exported scene in a folder of its own under the system's temporary one, removed at the end.
class ExportedScene {
 public:
  explicit ExportedScene(const SceneContext& context);
  ~ExportedScene();
  ExportedScene(const ExportedScene&) = delete;
  ExportedScene& operator=(const ExportedScene&) = delete;
  const std::string& folder() const { return folder_; }

 private:
  std::string folder_;
};

/// Runs the variant's command once; exports the scene for it if that has not been done. Its row has the command's wall
/// time and the frame times that it printed, lines `time_ms: X`. What goes wrong is the row's failure; throws nothing
/// but Interrupted.
Checked check_external(const Variant& variant, const SceneContext& context, const Suite& suite,
                       std::optional<ExportedScene>& exported);

}  // namespace penumbra
