// kernel.h for the device.
#pragma once

#include <concepts>
#include <cstddef>
#include <source_location>

#include "cuda/runtime.h"

#define PENUMBRA_SHARED(T, name, count)      \
  __shared__ T name##_memory[count];         \
  const penumbra::cuda::SharedSpan<T> name { \
    name##_memory                            \
  }
#define PENUMBRA_UNROLL _Pragma("unroll")
#define PENUMBRA_KERNEL(f) \
  penumbra::cuda::Kernel { \
#f, f                  \
  }

namespace penumbra::cuda {

/// Device memory; not owned.
template <class T>
struct Span {
  T* data = nullptr;
  std::size_t size = 0;
  __device__ T& operator[](std::size_t i) const { return data[i]; }
  template <std::same_as<const T> U>
  __host__ __device__ operator Span<U>() const {
    return {data, size};
  }
};

template <class T>
struct SharedSpan {
  T* data;
  __device__ T& operator[](unsigned i) const { return data[i]; }
};

template <class Array, class T>
__device__ T atomic_add(const Array& array, std::size_t i, T value) {
  return atomicAdd(&array[i], value);
}

__device__ inline void tally(float) {}

template <class... P>
struct Kernel {
  const char* name;
  void (*function)(P...);
  std::source_location where;
  Kernel(const char* n, void (*f)(P...), std::source_location w = std::source_location::current())
      : name(n), function(f), where(w) {}
};

/// Queues a kernel; nothing if there are no blocks. Throws DeviceError with the caller's file and line.
template <class... P, class... A>
void launch(const Stream& stream, const Kernel<P...>& kernel, unsigned blocks, unsigned threads,
            const A&... arguments) {
  if (blocks == 0) return;
  KernelTimer timer(stream, kernel.name);
  kernel.function<<<blocks, threads, 0, stream.handle()>>>(P(arguments)...);
  check(cudaGetLastError(), kernel.name, kernel.where);
}

}  // namespace penumbra::cuda
