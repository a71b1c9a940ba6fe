#include "scenes/sphere_set.h"

#include <tbb/parallel_for.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "scenes/error.h"
#include "scenes/ray_scene.h"

namespace penumbra {

SphereSet transformed(SphereSet set, const Similarity& fit) {
  for (Sphere& s : set.spheres) s = {fit(s.centre), fit.scale * s.radius};
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
  std::ofstream out(path);
  out << json.dump(1) << '\n';
  if (!out.flush()) throw Error("{}: cannot be written", path);
}

namespace {

std::vector<vec3> interior_points(const Mesh& mesh) {
  const Bounds box = bounds(mesh);
  const vec3 extent = box.extent();
  const float step = std::max({extent.x, extent.y, extent.z}) / 48.0f;
  const RayScene rays(mesh);
  std::vector<vec3> candidates;
  for (float y = box.low.y + 0.5f * step; y < box.high.y; y += step)
    for (float z = box.low.z + 0.5f * step; z < box.high.z; z += step)
      for (float x = box.low.x + 0.5f * step; x < box.high.x; x += step) candidates.emplace_back(x, y, z);
  std::vector<char> in(candidates.size());
  tbb::parallel_for(std::size_t(0), in.size(), [&](std::size_t i) { in[i] = inside(rays, candidates[i]); });
  std::vector<vec3> points;
  for (std::size_t i = 0; i < in.size(); ++i)
    if (in[i]) points.push_back(candidates[i]);
  return points;
}

/// k-means++ would need a random seed; farthest-point seeding is deterministic and spreads as well.
std::vector<vec3> farthest_points(const std::vector<vec3>& points, int count) {
  std::vector<vec3> seeds{points[0]};
  std::vector<float> distance(points.size(), std::numeric_limits<float>::max());
  while (int(seeds.size()) < count) {
    std::size_t farthest = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const vec3 d = points[i] - seeds.back();
      distance[i] = std::min(distance[i], glm::dot(d, d));
      if (distance[i] > distance[farthest]) farthest = i;
    }
    seeds.push_back(points[farthest]);
  }
  return seeds;
}

}  // namespace

SphereSet fit_spheres(const Mesh& mesh, int count) {
  validate(mesh, "sphere fit");
  if (count < 1) throw Error("sphere fit: {} spheres asked for; at least 1 is needed", count);
  std::vector<vec3> points = interior_points(mesh);
  if (int(points.size()) < 4 * count)
    for (const uvec3& t : mesh.triangles)
      points.push_back((mesh.positions[t.x] + mesh.positions[t.y] + mesh.positions[t.z]) / 3.0f);
  if (int(points.size()) < count)
    throw Error("sphere fit: {} spheres asked for, but the mesh only yields {} points", count, points.size());

  std::vector<vec3> centres = farthest_points(points, count);
  std::vector<int> cluster(points.size());
  std::vector<dvec3> sum(count);
  std::vector<double> members(count), moment(count);
  for (int iteration = 0; iteration < 40; ++iteration) {
    tbb::parallel_for(std::size_t(0), points.size(), [&](std::size_t i) {
      float best = std::numeric_limits<float>::max();
      for (int k = 0; k < count; ++k) {
        const vec3 d = points[i] - centres[k];
        if (const float d2 = glm::dot(d, d); d2 < best) best = d2, cluster[i] = k;
      }
    });
    std::fill(sum.begin(), sum.end(), dvec3(0.0));
    std::fill(members.begin(), members.end(), 0.0);
    for (std::size_t i = 0; i < points.size(); ++i) sum[cluster[i]] += dvec3(points[i]), members[cluster[i]] += 1.0;
    for (int k = 0; k < count; ++k)
      if (members[k] > 0) centres[k] = vec3(sum[k] / members[k]);
  }
  std::fill(moment.begin(), moment.end(), 0.0);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const vec3 d = points[i] - centres[cluster[i]];
    moment[cluster[i]] += glm::dot(d, d);
  }
  SphereSet set;
  for (int k = 0; k < count; ++k)
    if (members[k] > 0) set.spheres.push_back({centres[k], float(std::sqrt(5.0 / 3.0 * moment[k] / members[k]))});
  return set;
}

}  // namespace penumbra
