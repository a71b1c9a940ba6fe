// What kernels are counted and timed on: every technique with kernels, its default parameters and its own workloads
// (Kernels::workloads), on a scene of 128 x 128 receivers under an environment or a view of 1024 x 1024 under a lamp.
#pragma once

#include <algorithm>
#include <nlohmann/json.hpp>

#include "scenes/scene_file.h"
#include "techniques/registry.h"

namespace penumbra {

/// The middle of a scene's receivers, `edge` x `edge` at most: neighbours stay neighbours.
inline Scene middle_of(const Scene& scene, int edge) {
  const Receivers& all = scene.receivers;
  const int width = std::min(edge, all.width), height = std::min(edge, all.height);
  const int left = (all.width - width) / 2, top = (all.height - height) / 2;
  std::vector<std::size_t> which;
  for (int y = top; y < top + height; ++y)
    for (int x = left; x < left + width; ++x) which.push_back(std::size_t(y) * std::size_t(all.width) + std::size_t(x));
  Scene out = scene;
  out.receivers = subset(all, which, width, height);
  return out;
}

/// Calls f(entry, parameters, scene) for every workload.
template <class F>
void for_each_workload(const Registry& registry, int edge, const F& f) {
  const Scene environment = middle_of(load_scene("torus-knot-sunset"), edge),
              lamp = middle_of(load_scene("soft-random"), edge);
  for (const Entry& entry : registry.entries()) {
    if (entry.backend != Backend::cuda) continue;
    const Parameters usual = Parameters().resolve(entry.parameters, entry.title());
    const Scene& scene = entry.lights.environment ? environment : lamp;
    f(entry, usual, scene);
    for (const Parameters& given : entry.kernels->workloads)
      f(entry, given.resolve(entry.parameters, entry.title()), scene);
  }
}

/// The kernel's name with its template arguments as values: launches name them as the source does.
inline std::string readable_kernel(std::string name, const Parameters& parameters) {
  const auto replace = [&](const std::string& from, const std::string& to) {
    for (std::size_t at = name.find(from); at != std::string::npos; at = name.find(from))
      name.replace(at, from.size(), to);
  };
  if (name.front() == '(') name = name.substr(1, name.size() - 2);
  if (parameters.all().contains("order")) replace("<order", "<" + std::to_string(parameters.integer("order")));
  if (parameters.all().contains("visibility")) {
    const std::string from = parameters.text("visibility") == "raster" ? "raster" : "table";
    replace("<from", "<" + from), replace(", any_normal", "");
  }
  replace("From::", ""), replace("Sum::", "");
  return name;
}

/// How a row of a report begins.
inline nlohmann::json report_row(const Entry& entry, const Parameters& parameters, const Scene& scene) {
  return {{"technique", entry.name},
          {"parameters", parameters.describe()},
          {"scene", scene.name},
          {"spheres", scene.spheres.size()},
          {"receivers", scene.receivers.size()}};
}

}  // namespace penumbra
