#include "techniques/bases/irradiance_table.h"

#include <algorithm>
#include <cmath>

#include "techniques/bases/for_ranges.h"

namespace penumbra {
namespace {

constexpr int block_edge = 48;  // blocks along an edge of a cube's face

/// Vectors of the blocks that are not black, by channel and component.
struct Blocks {
  std::vector<float> vector[3][3];
  double solid_angle = 0.0;  ///< effective_solid_angle()
};

Blocks make_blocks(const Environment& environment) {
  struct Block {
    dvec3 channel[3] = {dvec3(0.0), dvec3(0.0), dvec3(0.0)};
    double energy = 0.0, size = 0.0;
  };
  std::vector<Block> all(std::size_t(6) * block_edge * block_edge);
  for (std::size_t texel = 0; texel < environment.radiance.size(); ++texel) {
    const vec3 radiance = environment.radiance[texel];
    const vec3 direction = environment.direction(int(texel), 0.5f, 0.5f);
    const double size = environment.solid_angle(int(texel));
    Block& block = all[std::size_t(cube_texel(direction, block_edge))];
    for (int c = 0; c < 3; ++c) block.channel[c] += double(radiance[c]) * size * dvec3(direction);
    block.energy += double(luminance(radiance)) * size;
    block.size += size;
  }
  Blocks blocks;
  double sum = 0.0, squares = 0.0;
  for (auto& channel : blocks.vector)
    for (auto& component : channel) component.reserve(all.size());
  for (const Block& block : all) {
    if (!(block.energy > 0.0)) continue;
    for (int c = 0; c < 3; ++c)
      for (int axis = 0; axis < 3; ++axis) blocks.vector[c][axis].push_back(float(block.channel[c][axis]));
    sum += block.energy;
    squares += block.energy * block.energy / block.size;
  }
  blocks.solid_angle = squares > 0.0 ? sum * sum / squares : 0.0;
  return blocks;
}

/// Sum of max(0, N.M) in groups, so that single precision does.
double sum_above(const std::vector<float>* m, vec3 n) {
  constexpr std::size_t group = 256;
  const std::size_t count = m[0].size();
  double sum = 0.0;
  for (std::size_t begin = 0; begin < count; begin += group) {
    const std::size_t end = std::min(count, begin + group);
    float part[4] = {};
    std::size_t k = begin;
    for (; k + 4 <= end; k += 4)
      for (std::size_t l = 0; l < 4; ++l) {
        const float above = n.x * m[0][k + l] + n.y * m[1][k + l] + n.z * m[2][k + l];
        part[l] += above > 0.0f ? above : 0.0f;
      }
    for (; k < end; ++k) part[0] += std::max(0.0f, n.x * m[0][k] + n.y * m[1][k] + n.z * m[2][k]);
    sum += double(part[0] + part[1]) + double(part[2] + part[3]);
  }
  return sum;
}

}  // namespace

IrradianceTable::Cell IrradianceTable::cell_of(vec3 normal) {
  float s, t;
  const int face = cube_face(normal, s, t), row_length = edge + 1;
  const float x = (s + 1.0f) * (0.5f * edge), y = (t + 1.0f) * (0.5f * edge);
  const int column = std::clamp(int(x), 0, edge - 1), row = std::clamp(int(y), 0, edge - 1);
  return {(face * row_length + row) * row_length + column, x - float(column), y - float(row)};
}

IrradianceTable::IrradianceTable(const Environment& environment, std::span<const vec3> normals) {
  constexpr int row_length = edge + 1;
  std::vector<std::uint8_t> wanted(std::size_t(6) * row_length * row_length, 0);
  for (const vec3 normal : normals) {
    if (normal == vec3(0.0f)) continue;
    const auto node = std::size_t(cell_of(normal).node);
    wanted[node] = wanted[node + 1] = wanted[node + row_length] = wanted[node + row_length + 1] = 1;
  }
  const Blocks blocks = make_blocks(environment);
  solid_angle_ = blocks.solid_angle;
  nodes_.assign(wanted.size(), vec3(0.0f));
  for_ranges(int(wanted.size()), 16, [&](int begin, int end) {
    for (int k = begin; k < end; ++k) {
      if (wanted[std::size_t(k)] == 0) continue;
      const int face = k / (row_length * row_length), row = k / row_length % row_length, column = k % row_length;
      const vec3 normal =
          glm::normalize(cube_direction(face, float(2 * column) / edge - 1.0f, float(2 * row) / edge - 1.0f));
      for (int c = 0; c < 3; ++c) nodes_[std::size_t(k)][c] = float(sum_above(blocks.vector[c], normal) / pi);
    }
  });
}

vec3 IrradianceTable::at(vec3 normal) const {
  const Cell cell = cell_of(normal);
  const vec3* above = &nodes_[std::size_t(cell.node)];
  const vec3* below = above + (edge + 1);
  return glm::mix(glm::mix(above[0], above[1], cell.s), glm::mix(below[0], below[1], cell.s), cell.t);
}

}  // namespace penumbra
