// A shrub: stems that fork into twigs, twigs that carry leaves at the golden angle.
#include <cmath>
#include <random>

#include "scenes/shapes.h"

namespace penumbra {
namespace {

constexpr float golden_angle = 2.39996323f;

class Shrub {
 public:
  explicit Shrub(unsigned seed) : random_(seed) {}

  Mesh grow() {
    constexpr int stems = 7;
    for (int k = 0; k < stems; ++k) {
      const float lean = 0.12f + 0.35f * unit(), angle = golden_angle * float(k) + 0.5f * unit();
      const vec3 along = glm::normalize(vec3(lean * std::cos(angle), 1.0f, lean * std::sin(angle)));
      stem({0.04f * std::cos(angle), 0.0f, 0.04f * std::sin(angle)}, along, 1.3f + 0.7f * unit());
    }
    return std::move(mesh_);
  }

 private:
  struct Joint {
    vec3 at, along;
  };

  float unit() { return float(random_() >> 8) * 0x1p-24f; }
  vec3 jitter(float size) {
    const float x = unit(), y = unit(), z = unit();
    return size * (2.0f * vec3(x, y, z) - 1.0f);
  }

  /// Two unit vectors across `along`.
  static std::pair<vec3, vec3> across(vec3 along) {
    const vec3 side = glm::normalize(glm::cross(along, std::abs(along.y) < 0.9f ? vec3(0, 1, 0) : vec3(1, 0, 0)));
    return {side, glm::cross(side, along)};
  }

  /// A curved path whose direction wanders and is drawn by `pull`.
  std::vector<Joint> path(vec3 from, vec3 along, float length, int parts, vec3 pull) {
    std::vector<Joint> joints{{from, along}};
    for (int k = 0; k < parts; ++k) {
      along = glm::normalize(along + pull + jitter(0.12f));
      from += length / float(parts) * along;
      joints.push_back({from, along});
    }
    return joints;
  }

  /// A closed tube along a path that tapers to a point.
  void tube(const std::vector<Joint>& joints, float radius) {
    constexpr unsigned around = 6;
    const auto first = unsigned(mesh_.positions.size()), rings = unsigned(joints.size()) - 1;
    for (unsigned i = 0; i < rings; ++i) {
      const auto [u, v] = across(joints[i].along);
      const float r = radius * (1.0f - float(i) / float(rings));
      for (unsigned j = 0; j < around; ++j) {
        const float a = 2.0f * float(pi) * float(j) / float(around);
        mesh_.positions.push_back(joints[i].at + r * (std::cos(a) * u + std::sin(a) * v));
      }
    }
    const auto at = [&](unsigned i, unsigned j) { return first + i * around + j % around; };
    const auto foot = unsigned(mesh_.positions.size()), tip = foot + 1;
    mesh_.positions.push_back(joints.front().at);
    mesh_.positions.push_back(joints.back().at);
    for (unsigned j = 0; j < around; ++j) {
      for (unsigned i = 0; i + 1 < rings; ++i) {
        mesh_.triangles.emplace_back(at(i, j), at(i, j + 1), at(i + 1, j));
        mesh_.triangles.emplace_back(at(i, j + 1), at(i + 1, j + 1), at(i + 1, j));
      }
      mesh_.triangles.emplace_back(foot, at(0, j + 1), at(0, j));
      mesh_.triangles.emplace_back(at(rings - 1, j), at(rings - 1, j + 1), tip);
    }
  }

  /// A closed lens, pointed at both ends and folded along its middle.
  void leaf(vec3 foot, vec3 along, vec3 up, float length) {
    const vec3 side = glm::normalize(glm::cross(along, up)), top = glm::cross(side, along);
    const vec3 middle = foot + 0.45f * length * along, droop = -0.1f * length * top;
    const float wide = 0.22f * length, thick = 0.01f * length;
    const auto first = unsigned(mesh_.positions.size());
    mesh_.positions.insert(mesh_.positions.end(),
                           {foot, foot + length * along + droop, middle - wide * side, middle + wide * side,
                            middle - (0.04f * length - thick) * top, middle - (0.04f * length + thick) * top});
    const unsigned rim[4] = {0, 3, 1, 2};  // counter-clockwise seen from `top`
    for (unsigned k = 0; k < 4; ++k) {
      const unsigned a = first + rim[k], b = first + rim[(k + 1) % 4];
      mesh_.triangles.emplace_back(a, b, first + 4);
      mesh_.triangles.emplace_back(b, a, first + 5);
    }
  }

  void twig(vec3 from, vec3 along, float length) {
    constexpr int parts = 40;
    const std::vector<Joint> joints = path(from, along, length, parts, {0.0f, -0.02f, 0.0f});
    tube(joints, 0.006f);
    for (int k = 4; k <= parts; ++k) {
      const auto [u, v] = across(joints[std::size_t(k)].along);
      const float a = golden_angle * float(k);
      const vec3 out = std::cos(a) * u + std::sin(a) * v;
      const vec3 towards = glm::normalize(out + 0.6f * joints[std::size_t(k)].along + jitter(0.2f));
      leaf(joints[std::size_t(k)].at, towards, glm::normalize(vec3(0, 1, 0) + 0.4f * out), 0.1f + 0.05f * unit());
    }
  }

  void stem(vec3 from, vec3 along, float length) {
    constexpr int parts = 14;
    const std::vector<Joint> joints = path(from, along, length, parts, vec3(0.0f));
    tube(joints, 0.025f);
    for (int k = 3; k <= parts; ++k) {
      const auto [u, v] = across(joints[std::size_t(k)].along);
      const float a = golden_angle * float(k), share = float(k) / float(parts);
      const vec3 towards = std::cos(a) * u + std::sin(a) * v + 0.7f * joints[std::size_t(k)].along;
      twig(joints[std::size_t(k)].at, glm::normalize(towards), (0.75f - 0.4f * share) * (0.8f + 0.4f * unit()));
    }
  }

  std::mt19937 random_;  // its numbers are fixed by the standard; the library's distributions are not
  Mesh mesh_;
};

}  // namespace

Mesh make_foliage(unsigned seed) {
  return Shrub(seed).grow();
}

}  // namespace penumbra
