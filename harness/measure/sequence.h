// A technique over all frames of a motion: errors, flicker, coverage, and a contact sheet.
#pragma once

#include <functional>

#include "harness/measure/reference.h"
#include "harness/results/row.h"
#include "techniques/technique.h"

namespace penumbra {

/// The truths of a scene's frames, made once for all techniques.
class Sequence {
 public:
  /// References come from the cache where it holds them; `progress` is told how far all of them are. The scene must
  /// outlive this.
  Sequence(const Scene& scene, const ReferenceSettings& settings, const ReferenceProgress& progress);

  /// Shades every frame. The technique must be prepared. Writes a contact sheet: truth, image and signed error in
  /// columns by frame; one that cannot be written is a warning.
  SequenceErrors score(Technique& technique, double exposure, const std::string& sheet_file) const;

 private:
  const Scene& scene_;
  std::vector<Image> truth_;
  std::vector<std::vector<bool>> valid_;
  std::vector<double> coverage_, black_;  ///< black_: the RMS up to which a frame's truth counts as black
  std::vector<std::optional<double>> rel_noise_;
  double carry_ms_ = 0.0;
};

}  // namespace penumbra
