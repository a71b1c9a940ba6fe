#include "harness/measure/chosen_frame.h"

#include "scenes/error.h"

namespace penumbra {

int scored_frame(const Animation& animation) {
  return animation.frames() / 3;
}

int chosen_frame(const Animation& animation, std::optional<int> wanted) {
  const int frames = animation.frames();
  if (wanted && (*wanted < 0 || *wanted >= frames))
    throw Error(
        "--frame {}: scene '{}' {}", *wanted, animation.scene().name,
        frames == 1 ? "does not move; it has frame 0 alone" : fmt::format("has the frames 0 to {}", frames - 1));
  return wanted.value_or(scored_frame(animation));
}

std::string frame_text(const Animation& animation, int frame) {
  return animation.frames() == 1 ? "" : fmt::format("frame {} of 0 to {}", frame, animation.frames() - 1);
}

}  // namespace penumbra
