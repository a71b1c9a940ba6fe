// The binary Haar transform on the device, and products with it, by one block for one receiver. Arrays are in shared or
// in device memory.
#pragma once

#include "cuda/visibility.h"
#include "techniques/wavelet/sparse_product.h"

namespace penumbra::PENUMBRA_CUDA_NAMESPACE {

/// haar::BinaryTable on the device.
struct BinaryTableSpan {
  Span<const std::int8_t> entries;
  __device__ int at(unsigned block, int entry) const { return entries[block * 16 + unsigned(entry)]; }
};

/// A receiver's visibility in the two-level store, with psum(V) down to blocks (wavelet::Visibility).
template <class Floats, class Blocks>
struct TwoLevelVisibility {
  int edge;
  Floats level1, means;
  Blocks blocks;
  BinaryTableSpan table;

  PENUMBRA_HD int n() const { return edge; }
  PENUMBRA_HD int blocks_per_face() const { return edge * edge / 16; }
  PENUMBRA_HD int means_per_face() const { return haar::pyramid_size(haar::levels_of(edge / 4)); }
  __device__ float coefficient(int face, int index) const {
    tally(2);
    return haar::two_level_coefficient(level1, blocks, table, edge, face, index);
  }
  __device__ float mean(int face, haar::Square s) const {
    return means[unsigned(face * means_per_face() + haar::pyramid_index(s))];
  }
};

/// Table index of every 4 x 4 block, and how much of it is open: a thread a block.
template <class Words, class V>
__device__ void find_blocks(const Words& words, const V& v) {
  const int m = v.edge / 4, per_face = v.blocks_per_face(), levels = haar::levels_of(m);
  for (int b = int(threadIdx.x); b < 6 * per_face; b += int(blockDim.x)) {
    const int face = b / per_face, j = b % per_face / m, i = b % m;
    unsigned index = 0;
    for (int row = 0; row < 4; ++row) {
      const unsigned t = unsigned((face * v.edge + 4 * j + row) * v.edge + 4 * i);
      const std::uint32_t word = words[t >> 5];
      index |= (word >> (t & 31) & 15u) << (4 * row);
    }
    v.blocks[unsigned(b)] = std::uint16_t(index);
    v.means[unsigned(face * v.means_per_face() + haar::pyramid_index({levels, i, j}))] =
        1.0f - float(v.table.at(index, 0)) * (1.0f / 16.0f);
    tally(2);
  }
}

/// Means to coefficients, level by level towards the scale. Barriers before, between and after.
template <class V>
__device__ void transform_means(const V& v) {
  const int per_face = v.blocks_per_face(), size = v.means_per_face();
  for (int level = haar::levels_of(v.edge / 4) - 1; level >= 0; --level) {
    __syncthreads();
    const int squares = 1 << (2 * level);
    for (int k = int(threadIdx.x); k < 6 * squares; k += int(blockDim.x)) {
      const int face = k / squares, j = k % squares >> level, i = k & ((1 << level) - 1);
      const auto child = [&](int x, int y) -> float {
        return v.means[unsigned(face * size + haar::pyramid_index({level + 1, 2 * i + x, 2 * j + y}))];
      };
      const float a = child(0, 0), b = child(1, 0), c = child(0, 1), d = child(1, 1);
      const auto coefficient = [&](int mother, float value) {
        v.level1[unsigned(face * per_face + haar::coefficient_index({level, i, j}, mother))] =
            0.25f / float(1 << level) * value;
      };
      coefficient(haar::m01, (a - b) + (c - d));
      coefficient(haar::m10, (a + b) - (c + d));
      coefficient(haar::m11, (a - b) - (c - d));
      const float mean = 0.25f * ((a + b) + (c + d));
      v.means[unsigned(face * size + haar::pyramid_index({level, i, j}))] = mean;
      if (level == 0) v.level1[unsigned(face * per_face)] = mean;
      tally(14);
    }
  }
  __syncthreads();
}

/// Element `which` of arrays of `size`, one after the other.
template <class T>
__device__ Span<T> part(const Span<T>& all, std::size_t which, int size) {
  return {all.data + which * std::size_t(size), std::size_t(size)};
}

/// Functions on the six faces, one after the other, or one of them (wavelet::Function).
struct FunctionSpans {
  int n;
  Span<const float> coefficients, means;
  __device__ int means_per_face() const { return haar::pyramid_size(haar::levels_of(n)); }
  __device__ FunctionSpans of(std::size_t which) const {
    return {n, part(coefficients, which, 6 * n * n), part(means, which, 6 * means_per_face())};
  }
  __device__ float at(int face, int index) const { return coefficients[unsigned(face * n * n + index)]; }
  __device__ float mean(int face, haar::Square s) const {
    return means[unsigned(face * means_per_face() + haar::pyramid_index(s))];
  }
};

/// Functionals, one after the other (wavelet::Functional).
struct FunctionalSpans {
  Span<const float> level1;       ///< [functional][channel][6 (n/4)^2]
  Span<const std::int32_t> slot;  ///< [functional][6 (n/4)^2]: position in level2, or -1
  Span<const float> level2;       ///< [slot][channel][16]
};

/// This thread's part of a functional of V: a coefficient of level 1 and the block at its place, in turn. Three
/// channels for a normal; or for any, nine, channel by channel and axis by axis.
template <bool any_normal, class V>
__device__ vec3 apply_functional(const FunctionalSpans& f, std::size_t which, vec3 normal, const V& v) {
  constexpr unsigned axes = any_normal ? 3 : 1, channels = 3 * axes;
  const unsigned size = 6 * unsigned(v.blocks_per_face());
  vec3 sum(0.0f);
  const auto add = [&](unsigned channel, float value) {
    sum[int(channel / axes)] += any_normal ? normal[int(channel % axes)] * value : value;
  };
  for (unsigned k = threadIdx.x; k < size; k += blockDim.x) {
    const float value = v.level1[k];
    for (unsigned c = 0; c < channels; ++c) add(c, f.level1[(which * channels + c) * size + k] * value);
    tally(float(2 * channels));
    const unsigned block = v.blocks[k];
    const std::int32_t slot = f.slot[which * size + k];
    if (slot < 0 || block == 0 || block == 0xffff) continue;
    for (int entry = 1; entry < 16; ++entry) {
      const auto row = float(v.table.at(block, entry));
      for (unsigned c = 0; c < channels; ++c)
        add(c, f.level2[(unsigned(slot) * channels + c) * 16 + unsigned(entry)] * row);
      tally(float(2 * channels));
    }
  }
  return sum;
}

}  // namespace penumbra::PENUMBRA_CUDA_NAMESPACE
