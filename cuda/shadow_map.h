// The shadow map on the device: shadow_map::ShadowMap, whose rays the host traces.
#pragma once

#include "cuda/kernel.h"
#include "techniques/bases/shadow_map/shadow_map.h"

namespace penumbra::PENUMBRA_CUDA_NAMESPACE {

struct MapSpans {
  Span<const float> depth;
  int edge, row;
  __device__ int resolution() const { return edge; }
  __device__ std::size_t index(int x, int y) const { return std::size_t(y) * std::size_t(row) + std::size_t(x); }
  __device__ float at(int x, int y) const {
    tally(2);
    return depth[index(x, y)];
  }
};

}  // namespace penumbra::PENUMBRA_CUDA_NAMESPACE
