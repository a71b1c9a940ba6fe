#include "harness/commands/save_image.h"

#include "harness/measure/black_truth.h"
#include "harness/measure/reference.h"
#include "harness/results/metrics.h"
#include "harness/results/pictures.h"
#include "scenes/error.h"

namespace penumbra {

void save_image(const std::string& path, const Image& image, const Frame& frame) {
  if (path.ends_with(".exr")) return save_exr(path, image);
  if (!path.ends_with(".png")) throw Error("-o {}: the name must end in .exr or .png", path);
  const double light = light_scale(frame.light, frame.receivers);
  save_png(path, exposed(image, exposure_for(image, valid_receivers(frame.receivers), light)));
}

}  // namespace penumbra
