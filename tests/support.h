// Scenes and helpers that tests share.
#pragma once

#include <gtest/gtest.h>
#include <spdlog/sinks/ostream_sink.h>
#include <spdlog/spdlog.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "cuda/host/registry.h"
#include "scenes/import/guard.h"
#include "scenes/shapes.h"
#include "techniques/registry.h"

namespace penumbra::test {

/// What is logged during a call.
template <class Call>
std::string messages_of(Call call) {
  std::ostringstream text;
  const auto before = spdlog::default_logger();
  spdlog::set_default_logger(
      std::make_shared<spdlog::logger>("test", std::make_shared<spdlog::sinks::ostream_sink_mt>(text)));
  call();
  spdlog::set_default_logger(before);
  return text.str();
}

inline Environment constant_environment(vec3 radiance = vec3(1.0f)) {
  Environment e;
  make_environment("constant", e);
  for (vec3& texel : e.radiance) texel = radiance;
  return e;
}

inline Receivers receivers_at(const std::vector<vec3>& positions, vec3 normal = {0, 1, 0}) {
  Receivers r;
  r.width = int(positions.size());
  r.height = 1;
  r.position = positions;
  r.normal.assign(positions.size(), glm::normalize(normal));
  r.albedo.assign(positions.size(), vec3(1.0f));
  r.on_occluder.assign(positions.size(), 0);
  return r;
}

/// Spheres (also as a mesh) under constant light 1, so that radiance is e = 1 - blocked fraction.
inline Scene sphere_scene(const std::vector<Sphere>& spheres, const Receivers& receivers) {
  Scene scene;
  scene.name = "test";
  scene.spheres.spheres = spheres;
  scene.receivers = receivers;
  scene.receiver_spec.kind = PlaneGrid{};
  scene.light = constant_environment();
  for (const Sphere& s : spheres) {
    if (scene.mesh.positions.size() > 200000) break;
    append(scene.mesh, make_sphere(s.centre, s.radius, 96));
  }
  return scene;
}

/// A sphere of angular radius `theta` (radians) at distance 1 in direction v from the origin.
inline Sphere cap_sphere(vec3 v, double theta) {
  return {glm::normalize(v), float(std::sin(theta))};
}

inline std::vector<vec3> shade(Technique& technique, const Scene& scene) {
  technique.prepare(scene);
  std::vector<vec3> image(std::size_t(scene.receivers.size()), vec3(-1.0f));
  technique.shade({image.data(), scene.receivers.width, scene.receivers.height});
  return image;
}

inline std::vector<vec3> shade(const std::string& name, const std::string& backend,
                               const std::vector<std::string>& parameters, const Scene& scene) {
  static const Registry registry = cuda_on_host::make_registry();
  const auto technique = make_technique(registry.find(name, backend), parse_parameters(parameters));
  return shade(*technique, scene);
}

/// The defaults, but for the values that make the technique quick.
inline Parameters small_parameters(const Entry& entry) {
  return entry.small.resolve(entry.parameters, entry.title());
}

inline Image grey(const std::vector<float>& values, int width) {
  Image image{width, int(values.size()) / width, {}};
  for (const float v : values) image.pixels.emplace_back(v);
  return image;
}

/// Relative RMS difference of two images.
inline double difference(const std::vector<vec3>& a, const std::vector<vec3>& b) {
  double squared = 0.0, energy = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    squared += glm::dot(dvec3(a[i] - b[i]), dvec3(a[i] - b[i]));
    energy += glm::dot(dvec3(b[i]), dvec3(b[i]));
  }
  return energy > 0.0 ? std::sqrt(squared / energy) : std::sqrt(squared);
}

/// A folder of its own, removed at the end.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::string pattern = (std::filesystem::temp_directory_path() / "penumbra-XXXXXX").string();
    if (!mkdtemp(pattern.data())) throw std::runtime_error("no temporary folder");
    path_ = pattern;
  }
  ~TemporaryFolder() { std::filesystem::remove_all(path_); }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  const std::string& path() const { return path_; }
  std::string write(const std::string& name, const std::string& text) const {
    std::ofstream(path_ + "/" + name) << text;
    return path_ + "/" + name;
  }

 private:
  std::string path_;
};

inline std::string read_text(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// What a call throws, or "" if it does not.
template <class Call>
std::string error_of(Call call) {
  try {
    call();
  } catch (const std::exception& e) {
    return e.what();
  }
  return "";
}

}  // namespace penumbra::test
