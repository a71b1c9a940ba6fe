#include "harness/measure/foreign_image.h"

#include <cmath>

#include "scenes/error.h"
#include "scenes/image_input.h"

namespace penumbra {
namespace {

bool finite(vec3 v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

/// Throws Error that names the first valid receiver whose radiance is not finite.
void check_finite(const Image& image, const Receivers& receivers, const std::string& path) {
  int first = -1, count = 0;
  for (int i = 0; i < receivers.size(); ++i)
    if (receivers.valid(i) && !finite(image.pixels[std::size_t(i)])) {
      if (count++ == 0) first = i;
    }
  if (count == 0) return;
  const vec3 p = image.pixels[std::size_t(first)];
  throw Error("{}: {} of {} pixels are not finite, the first in column {}, row {}: ({}, {}, {}); mend the renderer",
              path, count, receivers.size(), first % receivers.width, first / receivers.width, p.x, p.y, p.z);
}

}  // namespace

Image load_foreign_image(const std::string& path, const Receivers& receivers, const std::string& scene) {
  if (!ImageInput(path).spec().format.is_floating_point())
    throw Error("{}: holds whole numbers, as for a screen, which are no radiance; write floats: .exr or .pfm", path);
  Image image = load_image(path);
  if (image.width != receivers.width || image.height != receivers.height)
    throw Error("{}: is {} x {} pixels, and scene '{}' has {} x {} receivers{}", path, image.width, image.height, scene,
                receivers.width, receivers.height, receivers.height == 1 ? ", its vertices in one row" : "");
  check_finite(image, receivers, path);
  for (int i = 0; i < receivers.size(); ++i)
    if (!receivers.valid(i)) image.pixels[std::size_t(i)] = vec3(0.0f);
  return image;
}

}  // namespace penumbra
