#include "techniques/several_lights.h"

#include <algorithm>

namespace penumbra {

void SeveralLights::prepare(const Scene& scene, const Light& light) {
  parts_.clear();
  for (const Light& one : each_of(light)) {
    parts_.push_back(make_(parts_.size()));
    parts_.back()->prepare(scene, one);
  }
}

void SeveralLights::update(const Frame& frame) {
  const std::span<const Light> lights = each_of(frame.light);
  for (std::size_t k = 0; k < parts_.size(); ++k)
    parts_[k]->update({frame.time, frame.mesh, frame.spheres, lights[k], frame.receivers, frame.changed});
}

void SeveralLights::shade(View<vec3> radiance) {
  std::fill_n(radiance.data, radiance.size(), vec3(0.0f));
  radiance_.resize(radiance.size());
  for (const auto& part : parts_) {
    part->shade({radiance_.data(), radiance.width, radiance.height});
    for (std::size_t i = 0; i < radiance_.size(); ++i) radiance[i] += radiance_[i];
  }
}

Footprint SeveralLights::footprint() const {
  Footprint sum;
  sum.per_frame = radiance_.capacity() * sizeof(vec3);
  for (const auto& part : parts_) {
    const Footprint one = part->footprint();
    sum.tables += one.tables, sum.per_scene += one.per_scene, sum.per_frame += one.per_frame;
  }
  return sum;
}

std::map<std::string, std::size_t> SeveralLights::counters() const {
  std::map<std::string, std::size_t> sum;
  for (const auto& part : parts_)
    for (const auto& [name, count] : part->counters()) sum[name] += count;
  return sum;
}

std::vector<Stage> SeveralLights::stages() const {
  std::vector<Stage> sum;
  for (const auto& part : parts_)
    for (const Stage& stage : part->stages()) {
      const auto at = std::find_if(sum.begin(), sum.end(), [&](const Stage& s) { return s.name == stage.name; });
      if (at == sum.end()) sum.push_back(stage);
      else at->ms += stage.ms;
    }
  return sum;
}

std::string SeveralLights::instruction_set() const {
  return parts_.empty() ? "" : parts_[0]->instruction_set();
}

}  // namespace penumbra
