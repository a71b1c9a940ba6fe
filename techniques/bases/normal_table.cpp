#include "techniques/bases/normal_table.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <unordered_map>

#include "scenes/cube_map.h"

namespace penumbra {
namespace {

constexpr int edge = 8;  // of the cube of cells
constexpr std::size_t few = 8;
constexpr std::uint16_t none = 0xffff;

struct Bits {
  std::size_t operator()(vec3 v) const {
    std::uint32_t bits[3];
    std::memcpy(bits, &v, sizeof(bits));
    std::uint64_t mixed = 0;
    for (const std::uint32_t b : bits) mixed = (mixed ^ b) * 0x9e3779b97f4a7c15ull, mixed ^= mixed >> 32;
    return std::size_t(mixed);
  }
};

/// The normals that deserve a group of their own, in the order of the receivers.
std::vector<vec3> shared_normals(const std::vector<vec3>& normals) {
  struct Shared {
    std::size_t first, count;
  };
  std::unordered_map<vec3, Shared, Bits> found;
  std::size_t valid = 0;
  for (std::size_t i = 0; i < normals.size(); ++i) {
    if (normals[i] == vec3(0.0f)) continue;
    ++valid;
    ++found.try_emplace(normals[i] + vec3(0.0f), Shared{i, 0}).first->second.count;  // -0 is 0
  }
  std::vector<std::size_t> firsts;
  for (const auto& [normal, shared] : found)
    if (found.size() <= few || 8 * shared.count >= valid) firsts.push_back(shared.first);
  std::sort(firsts.begin(), firsts.end());
  std::vector<vec3> chosen;
  chosen.reserve(firsts.size());
  for (const std::size_t first : firsts) chosen.push_back(normals[first]);
  return chosen;
}

/// The cone about the mean of a cell's normals, with room for rounding.
struct Bound {
  dvec3 sum{0.0};
  vec3 axis{0.0f};
  float cosine = 1.0f;
  Cone cone() const {
    const float least = std::max(-1.0f, cosine - 1e-6f);
    return {axis, std::sqrt(std::max(0.0f, 1.0f - least * least)), least};
  }
};

}  // namespace

NormalTable NormalTable::of(const std::vector<vec3>& normals) {
  NormalTable table;
  const std::vector<vec3> shared = shared_normals(normals);
  for (const vec3 normal : shared) table.cones.push_back({normal, 0.0f, 1.0f});
  table.index.assign(normals.size(), 0);
  std::vector<std::uint16_t> group_of_cell(std::size_t(6) * edge * edge, none);
  std::vector<Bound> bounds;
  for (std::size_t i = 0; i < normals.size(); ++i) {
    if (normals[i] == vec3(0.0f)) continue;
    const auto own = std::size_t(std::find(shared.begin(), shared.end(), normals[i]) - shared.begin());
    table.index[i] = std::uint16_t(own);
    if (own < shared.size()) continue;
    std::uint16_t& group = group_of_cell[std::size_t(cube_texel(normals[i], edge))];
    if (group == none) group = std::uint16_t(shared.size() + bounds.size()), bounds.emplace_back();
    table.index[i] = group;
    bounds[group - shared.size()].sum += dvec3(normals[i]);
  }
  for (Bound& bound : bounds) bound.axis = vec3(glm::normalize(bound.sum));
  for (std::size_t i = 0; i < normals.size(); ++i)
    if (table.index[i] >= shared.size() && normals[i] != vec3(0.0f)) {
      Bound& bound = bounds[table.index[i] - shared.size()];
      bound.cosine = std::min(bound.cosine, glm::dot(bound.axis, normals[i]));
    }
  for (const Bound& bound : bounds) table.cones.push_back(bound.cone());
  return table;
}

}  // namespace penumbra
