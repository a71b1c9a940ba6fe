// Which frame of a motion an image is of.
#pragma once

#include <optional>
#include <string>

#include "scenes/scene.h"

namespace penumbra {

/// The frame that images are made and scored of unless another is asked for: a third through the motion.
int scored_frame(const Animation& animation);

/// The frame that `--frame` asks for, or else the scored one. Throws Error if the scene has no such frame.
int chosen_frame(const Animation& animation, std::optional<int> wanted);

/// "frame 5 of 0 to 15", or "" for a scene without motion: there is nothing to choose.
std::string frame_text(const Animation& animation, int frame);

}  // namespace penumbra
