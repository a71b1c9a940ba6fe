// Someone else's renderer: knows nothing of penumbra but the files of an exported scene.
#pragma once

#include <fstream>
#include <nlohmann/json.hpp>
#include <random>
#include <sstream>

#include "scenes/image.h"

namespace penumbra::test {

/// Vertices and triangles of a binary PLY as export writes them.
struct PlainPly {
  std::map<std::string, std::vector<float>> properties;
  std::vector<uvec3> triangles;

  explicit PlainPly(const std::string& path) {
    std::ifstream in(path, std::ios::binary);
    std::vector<std::string> names;
    std::size_t vertices = 0, faces = 0;
    for (std::string line; std::getline(in, line) && line != "end_header";) {
      std::istringstream words(line);
      std::string word, what, name;
      words >> word >> what >> name;
      if (word == "element") (what == "vertex" ? vertices : faces) = std::stoul(name);
      if (word == "property" && what == "float") names.push_back(name);
    }
    for (std::size_t i = 0; i < vertices; ++i)
      for (const std::string& name : names) {
        float value = 0.0f;
        in.read(reinterpret_cast<char*>(&value), sizeof value);
        properties[name].push_back(value);
      }
    triangles.resize(faces);
    for (uvec3& t : triangles) {
      in.get();
      in.read(reinterpret_cast<char*>(&t), sizeof t);
    }
    if (!in) throw std::runtime_error(path + " ends too early");
  }
  dvec3 at(const char* x, const char* y, const char* z, std::size_t i) const {
    return {properties.at(x)[i], properties.at(y)[i], properties.at(z)[i]};
  }
  std::size_t size() const { return properties.empty() ? 0 : properties.begin()->second.size(); }
};

/// Renders the image of an exported folder by the formula of its scene.json: `samples` rays to each of the light's
/// texels, or samples^2 to a lamp, all triangles tested one by one. `variance`: of each pixel's mean.
class PlainRenderer {
 public:
  explicit PlainRenderer(const std::string& folder)
      : scene_(nlohmann::json::parse(std::ifstream(folder + "/scene.json"))), points_(folder + "/receivers.ply") {
    if (scene_["light"]["kind"] == "environment") light_ = load_channels(folder + "/light.exr");
    if (scene_["mesh"].is_null()) return;
    const PlainPly mesh(folder + "/mesh.ply");
    for (const uvec3& t : mesh.triangles)
      for (const unsigned corner : {t.x, t.y, t.z}) corners_.push_back(mesh.at("x", "y", "z", corner));
  }

  const nlohmann::json& scene() const { return scene_; }

  Image render(int samples, Image& variance) {
    Image image{scene_["image"]["width"], scene_["image"]["height"], {}};
    variance = image;
    for (std::size_t i = 0; i < points_.size(); ++i) {
      sum_ = squares_ = dvec3(0.0);
      ray_ = points_.at("ray_x", "ray_y", "ray_z", i), normal_ = points_.at("nx", "ny", "nz", i);
      if (normal_ != dvec3(0.0)) light_.values.empty() ? gather_lamp(samples * samples) : gather_texels(samples);
      const dvec3 factor = points_.at("albedo_r", "albedo_g", "albedo_b", i) / pi;
      image.pixels.emplace_back(factor * sum_);
      variance.pixels.emplace_back(factor * factor * squares_);
    }
    return image;
  }

 private:
  double uniform() { return std::uniform_real_distribution<>()(random_); }

  bool visible(dvec3 direction, double distance) const {  // Moeller & Trumbore 1997
    for (std::size_t k = 0; k < corners_.size(); k += 3) {
      const dvec3 u = corners_[k + 1] - corners_[k], v = corners_[k + 2] - corners_[k], from = ray_ - corners_[k];
      const dvec3 p = glm::cross(direction, v), q = glm::cross(from, u);
      const double det = glm::dot(u, p);
      if (det == 0.0) continue;
      const double a = glm::dot(from, p) / det, b = glm::dot(direction, q) / det, t = glm::dot(v, q) / det;
      if (a >= 0.0 && b >= 0.0 && a + b <= 1.0 && t > 0.0 && t < distance) return false;
    }
    return true;
  }

  /// One stratum: `count` values whose mean counts `weight` times.
  template <class Value>
  void add(int count, double weight, Value value) {
    dvec3 sum(0.0), squares(0.0);
    for (int k = 0; k < count; ++k) {
      const dvec3 x = value();
      sum += x, squares += x * x;
    }
    const dvec3 mean = sum / double(count);
    sum_ += weight * mean;
    squares_ += weight * weight * (squares / double(count) - mean * mean) / double(std::max(1, count - 1));
  }

  void gather_texels(int samples) {
    const double left = scene_["light"]["left_edge"];
    for (int y = 0; y < light_.height; ++y)
      for (int x = 0; x < light_.width; ++x) {
        const double top = std::cos(pi * y / light_.height), below = std::cos(pi * (y + 1) / light_.height);
        const double weight = 2.0 * pi / light_.width * (top - below);  // sr
        const float* radiance = &light_.values[(std::size_t(y) * light_.width + x) * 3];
        add(samples, weight, [&] {
          const double lon = left - 2.0 * pi * (x + uniform()) / light_.width;
          const double height = top + (below - top) * uniform(), across = std::sqrt(1.0 - height * height);
          const dvec3 w(std::sin(lon) * across, height, std::cos(lon) * across);
          const double cosine = glm::dot(normal_, w);
          return cosine > 0.0 && visible(w, INFINITY) ? cosine * dvec3(radiance[0], radiance[1], radiance[2])
                                                      : dvec3(0.0);
        });
      }
  }

  void gather_lamp(int samples) {
    const auto vector = [&](const char* key) {
      const auto& v = scene_["light"][key];
      return dvec3(v[0], v[1], v[2]);
    };
    const bool disc = scene_["light"]["kind"] == "disc";
    const dvec3 centre = vector("centre"), u = vector("edge_u"), v = vector("edge_v"), normal = vector("normal");
    const dvec3 radiance = vector("radiance");
    add(samples, scene_["light"]["area"], [&] {
      double a = uniform() - 0.5, b = uniform() - 0.5;
      while (disc && a * a + b * b > 0.25) a = uniform() - 0.5, b = uniform() - 0.5;
      const dvec3 to = centre + a * u + b * v - ray_;
      const double distance = glm::length(to);
      const dvec3 w = to / distance;
      const double cosines = std::max(0.0, glm::dot(normal_, w)) * std::max(0.0, -glm::dot(normal, w));
      return cosines > 0.0 && visible(w, distance) ? radiance * cosines / (distance * distance) : dvec3(0.0);
    });
  }

  nlohmann::json scene_;
  PlainPly points_;
  ChannelImage light_;
  std::vector<dvec3> corners_;
  dvec3 sum_, squares_, ray_, normal_;
  std::mt19937 random_{7};
};

}  // namespace penumbra::test
