#include <algorithm>
#include <cmath>
#include <limits>

#include "harness/measure/black_truth.h"
#include "harness/measure/chosen_frame.h"
#include "harness/measure/parity.h"

namespace penumbra {

namespace {

/// A copy: receivers may be most of a scene.
Scene without_receivers(const Scene& scene) {
  Scene out;
  out.name = scene.name, out.origin = scene.origin, out.mesh = scene.mesh;
  out.spheres = scene.spheres, out.entities = scene.entities, out.objective = scene.objective;
  out.light = scene.light, out.motion = scene.motion, out.receiver_spec = scene.receiver_spec;
  return out;
}

}  // namespace

Scene thinned(const Scene& scene, int edge) {
  const Receivers& all = scene.receivers;
  const int most_x = all.height == 1 ? edge * edge : edge;
  const int step_x = (all.width + most_x - 1) / most_x, step_y = (all.height + edge - 1) / edge;
  std::vector<std::size_t> which;
  for (int y = 0; y < all.height; y += step_y)
    for (int x = 0; x < all.width; x += step_x) which.push_back(std::size_t(y) * all.width + x);
  Scene out = without_receivers(scene);
  out.receivers = subset(all, which, (all.width + step_x - 1) / step_x, (all.height + step_y - 1) / step_y);
  return out;
}

namespace {

constexpr double parity_floor = 1e-2;

std::vector<vec3> shaded(const Entry& entry, const Parameters& parameters, const Scene& scene) {
  Parameters known;  // a device has some that its twin lacks
  for (const Parameter& p : entry.parameters)
    if (const auto at = parameters.all().find(p.name); at != parameters.all().end()) known.set(p.name, at->second);
  const auto technique = make_technique(entry, known, scene.light);
  technique->prepare(scene);
  Animation animation(scene);
  const Frame frame = animation.frame(scored_frame(animation));
  // Moving receivers are made anew in full; at rest they stay thin.
  if (!frame.changed.receivers) technique->update(frame);
  std::vector<vec3> image(std::size_t(scene.receivers.size()));
  technique->shade({image.data(), scene.receivers.width, scene.receivers.height});
  return image;
}

}  // namespace

double parity_with_scalar(const Registry& registry, const Entry& entry, const Parameters& parameters,
                          const Scene& scene) {
  const Entry* twin = registry.twin(entry, Backend::scalar);
  if (!twin || twin == &entry) return 0.0;
  const Scene thin = thinned(scene, 32);
  const auto ours = shaded(entry, parameters, thin), theirs = shaded(*twin, parameters, thin);
  double squared = 0.0, energy = 0.0;
  for (std::size_t i = 0; i < ours.size(); ++i) {
    const dvec3 a(ours[i]), b(theirs[i]);
    squared += glm::dot(a - b, a - b);
    energy += glm::dot(b, b);
  }
  if (squared == 0.0) return 0.0;
  // Both round at the scale of the light, however little of it is left in the image.
  const double count = 3.0 * double(ours.size());
  const double floor = parity_floor * light_scale(scene.light, thin.receivers);
  const double scale = std::max({std::sqrt(energy / count), floor, double(std::numeric_limits<float>::min())});
  return std::sqrt(squared / count) / scale;
}

}  // namespace penumbra
