#include "scenes/sphere_set.h"

#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>

#include "scenes/error.h"
#include "scenes/storage/atomic_write.h"
#include "scenes/storage/content_key.h"

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

SphereList widened(const SphereSet& set, dvec3 origin) {
  SphereList list;
  for (const Sphere& s : set.spheres) list.emplace_back(origin + dvec3(s.centre), double(s.radius));
  return list;
}

SphereSet narrowed(const SphereList& list, dvec3 origin) {
  SphereSet set;
  for (const glm::dvec4& s : list) set.spheres.push_back({vec3(dvec3(s) - origin), float(s.w)});
  return set;
}

SphereList transformed(SphereList list, const Similarity& fit) {
  for (glm::dvec4& s : list) s = {fit(dvec3(s)), fit.scale * s.w};
  return list;
}

SphereSet load_spheres(const std::string& path) {
  return narrowed(read_spheres(path), dvec3(0.0));
}

SphereList read_spheres(const std::string& path) {
  if (!std::filesystem::exists(path)) throw Error("{}: no such sphere file", path);
  nlohmann::json json;
  try {
    json = nlohmann::json::parse(std::ifstream(path));
  } catch (const nlohmann::json::exception& e) {
    throw Error("{}: not valid JSON: {}", path, e.what());
  }
  if (!json.is_object() || !json.contains("spheres") || !json["spheres"].is_array())
    throw Error("{}: expected {{\"spheres\": [[x, y, z, radius], ...]}}", path);
  SphereList list;
  for (const auto& item : json["spheres"]) {
    bool good = item.is_array() && item.size() == 4;
    for (std::size_t k = 0; good && k < 4; ++k) good = item[k].is_number();
    if (good) {
      const glm::dvec4& s = list.emplace_back(item[0], item[1], item[2], item[3]);
      good = glm::all(glm::lessThan(glm::abs(s), glm::dvec4(double(std::numeric_limits<float>::max())))) && s.w >= 0;
    }
    if (!good)
      throw Error("{}: spheres[{}] is {}; expected four finite numbers [x, y, z, radius >= 0]", path, list.size(),
                  item.dump());
  }
  if (json.contains("checksum") && json["checksum"] != checksum(list))
    throw Error("{}: the checksum does not match: a number has changed since the file was written", path);
  return list;
}

namespace {

nlohmann::json spheres_json(const SphereList& list) {
  nlohmann::json json;
  for (const glm::dvec4& s : list) json["spheres"].push_back({s.x, s.y, s.z, s.w});
  return json;
}

}  // namespace

void save_spheres(const std::string& path, const SphereSet& set, dvec3 origin) {
  write_atomically(path, spheres_json(widened(set, origin)).dump(1) + "\n");
}

void store_spheres(const std::string& path, const SphereSet& set) {
  const SphereList list = widened(set, dvec3(0.0));
  nlohmann::json json = spheres_json(list);
  json["checksum"] = checksum(list);
  write_atomically(path, json.dump(1) + "\n");
}

}  // namespace penumbra
