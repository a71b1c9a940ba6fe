#include "scenes/tree_decay.h"

#include <algorithm>
#include <numeric>

namespace penumbra {
namespace {

constexpr std::size_t group = 32;  // triangles

/// Every third bit, from the lowest on.
std::uint32_t spread(std::uint32_t x) {
  x = (x | x << 16) & 0x030000ffu;
  x = (x | x << 8) & 0x0300f00fu;
  x = (x | x << 4) & 0x030c30c3u;
  return (x | x << 2) & 0x09249249u;
}

/// Place of a triangle's centroid on a Morton curve through the box.
std::uint32_t place(const Mesh& mesh, uvec3 t, const Bounds& box) {
  const vec3 centroid = (mesh.positions[t.x] + mesh.positions[t.y] + mesh.positions[t.z]) / 3.0f;
  std::uint32_t code = 0;
  for (int c = 0; c < 3; ++c) {
    const float size = box.high[c] - box.low[c], at = size > 0.0f ? (centroid[c] - box.low[c]) / size : 0.0f;
    code |= spread(std::uint32_t(std::clamp(at * 1024.0f, 0.0f, 1023.0f))) << c;
  }
  return code;
}

double surface_of(const Bounds& box) {
  const dvec3 size(box.high - box.low);
  return size.x * size.y + size.y * size.z + size.z * size.x;
}

}  // namespace

TreeDecay::TreeDecay(const Mesh& mesh) : triangles_(mesh.triangles), order_(mesh.triangles.size()) {
  const Bounds box = bounds(mesh);
  std::vector<std::uint32_t> places;
  for (const uvec3 t : triangles_) places.push_back(place(mesh, t, box));
  std::iota(order_.begin(), order_.end(), 0u);
  std::stable_sort(order_.begin(), order_.end(), [&](auto a, auto b) { return places[a] < places[b]; });
  built_ = surface(mesh);
}

bool TreeDecay::same_triangles(const Mesh& mesh) const {
  return mesh.triangles == triangles_;
}

double TreeDecay::surface(const Mesh& mesh) const {
  double sum = 0.0;
  for (std::size_t first = 0; first < order_.size(); first += group) {
    Bounds box{mesh.positions[triangles_[order_[first]].x], mesh.positions[triangles_[order_[first]].x]};
    for (std::size_t k = first; k < std::min(order_.size(), first + group); ++k)
      for (int corner = 0; corner < 3; ++corner) {
        const vec3 p = mesh.positions[triangles_[order_[k]][corner]];
        box.low = glm::min(box.low, p), box.high = glm::max(box.high, p);
      }
    sum += surface_of(box);
  }
  const double whole = surface_of(bounds(mesh));
  return whole > 0.0 ? sum / whole : 1.0;
}

}  // namespace penumbra
