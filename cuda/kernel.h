// What the kernels are written with. A .cu file is compiled twice: by nvcc for the device, and as C++ for the host,
// where tests run it (host/execution.h). It is plain CUDA, with
//
//   namespace penumbra::PENUMBRA_CUDA_NAMESPACE    around it: `cuda` on the device, `cuda_on_host` on the host
//   Span<T>                                        for device memory, PENUMBRA_SHARED(T, name, n) for shared memory
//   atomic_add(array, i, value)                    for atomics on either
//   tally(n)                                       beside inner loops: n floating-point operations, free on a device
//   PENUMBRA_UNROLL                                before loops over arrays that belong in registers
//   launch(stream, PENUMBRA_KERNEL(f), blocks, threads, arguments...)
//
// Blocks and grids are one-dimensional; blocks are whole warps.
#pragma once

#ifdef __CUDACC__
#include "cuda/kernel_device.h"
#else
#include "cuda/host/kernel_host.h"
#endif

namespace penumbra::PENUMBRA_CUDA_NAMESPACE {

inline constexpr unsigned all_lanes = ~0u, warp_lanes = 32;

/// Number of this thread in the grid.
__device__ inline unsigned global_thread() {
  return blockIdx.x * blockDim.x + threadIdx.x;
}

/// Blocks of `threads` for `count` threads or more.
inline unsigned blocks_for(std::size_t count, unsigned threads) {
  return unsigned((count + threads - 1) / threads);
}

/// Sum over the 32 lanes of a warp, the same in every lane. All of them call it.
template <class T>
__device__ T warp_sum(T value) {
  for (unsigned step = warp_lanes / 2; step > 0; step /= 2) value += __shfl_xor_sync(all_lanes, value, step);
  return value;
}

/// Sum over a block of `warps` warps, in every thread of it; `scratch` holds a value a warp. All its threads call it.
template <class Shared>
__device__ float block_sum(float value, Shared scratch, unsigned warps) {
  value = warp_sum(value);
  __syncthreads();
  if (threadIdx.x % warp_lanes == 0) scratch[threadIdx.x / warp_lanes] = value;
  __syncthreads();
  float sum = 0.0f;
  for (unsigned w = 0; w < warps; ++w) sum += scratch[w];
  return sum;
}

}  // namespace penumbra::PENUMBRA_CUDA_NAMESPACE
