#include "harness/measure/black_truth.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "techniques/bases/light_sampling.h"

namespace penumbra {
namespace {

/// The light at one receiver of albedo 1, as in light_scale().
dvec3 most_light(const AreaLight& lamp, vec3 position) {
  const dvec3 to_lamp = dvec3(lamp.centre) - dvec3(position);
  const double factor = lamp.area() / (pi * glm::dot(to_lamp, to_lamp));
  return dvec3(lamp.radiance) * (factor < 1.0 ? factor : 1.0);
}

std::string text(vec3 v) {
  return fmt::format("({:.3g}, {:.3g}, {:.3g})", v.x, v.y, v.z);
}

std::string why_nothing_arrives(const Light& light, const Receivers& receivers) {
  if (each_of(light).size() > 1)
    return fmt::format("no receiver gets light of any of {} lights; the first: {}", each_of(light).size(),
                       why_nothing_arrives(each_of(light).front(), receivers));
  const AreaLight* lamp = area_light_of(light);
  if (!lamp)
    return total_energy(*environment_of(light)) == dvec3(0.0)
               ? "no receiver gets light: the environment is black"
               : "no receiver gets light: all of the environment's light comes from below the receivers' horizons";
  if (lamp->radiance == vec3(0.0f)) return "no receiver gets light: the lamp's radiance is 0";
  if (lamp->area() == 0.0) return "no receiver gets light: the lamp has no area";
  if (light_scale(light, receivers) <= std::numeric_limits<float>::min())
    return "no receiver gets light: the lamp is so small, so far away or so dim that what arrives is no float";
  return fmt::format("no receiver gets light; does the lamp face away? it shines along {} from {}", text(lamp->normal),
                     text(lamp->centre));
}

}  // namespace

double light_scale(const Light& light, const Receivers& receivers) {
  dvec3 everywhere(0.0);
  std::vector<const AreaLight*> lamps;
  for (const Light& one : each_of(light)) {
    if (const AreaLight* lamp = area_light_of(one)) lamps.push_back(lamp);
    else everywhere += total_energy(*environment_of(one)) / pi;
  }
  double sum = 0.0;
  std::size_t count = 0;
  for (int i = 0; i < receivers.size(); ++i) {
    if (!receivers.valid(i)) continue;
    dvec3 most = everywhere;
    for (const AreaLight* lamp : lamps) most += most_light(*lamp, receivers.position[i]);
    most *= dvec3(receivers.albedo[i]);
    sum += glm::dot(most, most);
    ++count;
  }
  return count ? std::sqrt(sum / (3.0 * double(count))) : 0.0;
}

double black_level(const Light& light, const Receivers& receivers) {
  return std::max(1e-12 * light_scale(light, receivers), double(std::numeric_limits<float>::min()));
}

bool light_arrives(const Light& light, const Receivers& receivers) {
  const double crumb = black_level(light, receivers);
  if (const std::span<const Light> lights = each_of(light); lights.size() > 1)
    return std::any_of(lights.begin(), lights.end(), [&](const Light& one) { return light_arrives(one, receivers); });
  const LightSampler sampler(light);
  LightSampler::Scratch scratch;
  for (int i = 0; i < receivers.size(); ++i) {
    if (!receivers.valid(i)) continue;
    sampler.draw(receivers.position[i], receivers.normal[i], 64, std::uint64_t(i), scratch);
    for (const LightSample& sample : scratch.samples)
      if (glm::dot(dvec3(receivers.albedo[i]), dvec3(sample.weight)) > crumb) return true;
  }
  return false;
}

std::string black_note(const std::string& scene, const Light& light, const Receivers& receivers, bool arrives) {
  int valid = 0;
  float albedo = 0.0f;
  for (int i = 0; i < receivers.size(); ++i) {
    if (!receivers.valid(i)) continue;
    ++valid;
    albedo = std::max({albedo, receivers.albedo[i].x, receivers.albedo[i].y, receivers.albedo[i].z});
  }
  std::string why;
  if (valid == 0) why = "there is no receiver: nothing is seen";
  else if (albedo == 0.0f) why = "every albedo is 0";
  else if (!arrives) why = why_nothing_arrives(light, receivers);
  else why = "no receiver gets light: the occluder is in the way of all of it";
  return fmt::format("scene {}: the truth is black: {}", scene, why);
}

}  // namespace penumbra
