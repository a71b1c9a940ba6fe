// Correctness before speed: one variant is shaded once, compared and scored.
#pragma once

#include "harness/measure/scene_context.h"

namespace penumbra {

/// A variant that has been looked at. Its row lacks the times of frames; one that failed or makes no sense on the scene
/// says why in its row and has no technique.
struct Checked {
  Row row;
  std::unique_ptr<Technique> technique;  ///< prepared, and has shaded
  double update_ms = 0.0;                ///< of the scored frame, once
  double shade_ms = 1.0;                 ///< the same, warm unless it is long
  double estimate_ms() const { return update_ms + shade_ms; }
  Image image;  ///< of the scored frame
};

/// Why a technique is not even tried under a light; empty if it is.
std::string reason_to_skip(const Entry& entry, const Light& light);

/// A row of which nothing is measured yet; skipped if the variant cannot run here or shade the light.
Row empty_row(const Variant& variant, const SceneContext& context, const Suite& suite);

/// Prepares (timed) and shades; refuses images that are not finite; scores. Never throws for what the technique does.
Checked look_at(const Variant& variant, const SceneContext& context, const Suite& suite);

/// As look_at(), and refuses images that differ from the scalar twin's. `sheet_file`: for the frames of a sequence.
Checked check(const Variant& variant, const SceneContext& context, const Suite& suite, const Registry& registry,
              const std::string& sheet_file);

}  // namespace penumbra
