#include "scenes/sphere_set.h"

#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "scenes/error.h"

namespace penumbra {

Bounds bounds(const SphereSet& set) {
  if (set.empty()) return {};
  Bounds box{set.spheres[0].centre, set.spheres[0].centre};
  for (const Sphere& s : set.spheres) {
    box.low = glm::min(box.low, s.centre - s.radius);
    box.high = glm::max(box.high, s.centre + s.radius);
  }
  return box;
}

SphereSet transformed(SphereSet set, const Similarity& fit) {
  for (Sphere& s : set.spheres) s = {vec3(fit(dvec3(s.centre))), float(fit.scale * double(s.radius))};
  return set;
}

SphereSet load_spheres(const std::string& path) {
  if (!std::filesystem::exists(path)) throw Error("{}: no such sphere file", path);
  nlohmann::json json;
  try {
    json = nlohmann::json::parse(std::ifstream(path));
  } catch (const nlohmann::json::exception& e) {
    throw Error("{}: not valid JSON: {}", path, e.what());
  }
  if (!json.is_object() || !json.contains("spheres") || !json["spheres"].is_array())
    throw Error("{}: expected {{\"spheres\": [[x, y, z, radius], ...]}}", path);
  SphereSet set;
  for (const auto& item : json["spheres"]) {
    bool good = item.is_array() && item.size() == 4;
    for (std::size_t k = 0; good && k < 4; ++k) good = item[k].is_number();
    if (good) {
      set.spheres.push_back({{item[0], item[1], item[2]}, item[3]});
      const Sphere& s = set.spheres.back();
      good = std::isfinite(s.centre.x + s.centre.y + s.centre.z + s.radius) && s.radius >= 0;
    }
    if (!good)
      throw Error("{}: spheres[{}] is {}; expected four finite numbers [x, y, z, radius >= 0]", path,
                  set.spheres.size(), item.dump());
  }
  return set;
}

void save_spheres(const std::string& path, const SphereSet& set) {
  nlohmann::json json;
  for (const Sphere& s : set.spheres) json["spheres"].push_back({s.centre.x, s.centre.y, s.centre.z, s.radius});
  const std::string partial = path + ".partial-" + std::to_string(getpid());
  std::ofstream out(partial);
  out << json.dump(1) << '\n';
  out.close();
  if (!out) throw Error("{}: cannot be written", path);
  std::filesystem::rename(partial, path);
}

}  // namespace penumbra
