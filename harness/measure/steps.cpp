#include "harness/measure/steps.h"

#include <fmt/format.h>

#include <algorithm>

namespace penumbra {
namespace {

/// Sum over valid receivers and channels of a * b.
double dot(const Image& a, const Image& b, const std::vector<bool>& valid) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.pixels.size(); ++i)
    if (valid[i]) sum += glm::dot(dvec3(a.pixels[i]), dvec3(b.pixels[i]));
  return sum;
}

}  // namespace

std::vector<StepError> attribute_error(const std::vector<Approximation>& approximations, const Image& rung,
                                       const Image& own, const std::vector<bool>& valid) {
  const double scale = rms(rung, valid);
  if (!(scale > 0.0)) return {};
  const Image whole = difference(own, rung);
  const double squared = dot(whole, whole, valid);
  std::vector<StepError> steps;
  Image before = rung;
  for (const Approximation& at : approximations) {
    const Image after = at.radiance.empty() ? own : Image{rung.width, rung.height, at.radiance};
    const Image step = difference(after, before);
    steps.push_back({at.name, rms(step, valid) / scale, squared > 0.0 ? dot(step, whole, valid) / squared : 0.0});
    before = after;
  }
  return steps;
}

}  // namespace penumbra
