// kernel.h for the host: CUDA's words with the meaning that host/execution.h gives them. Only .cu files see it.
#pragma once

#include <atomic>
#include <bit>
#include <cmath>
#include <concepts>
#include <cstring>
#include <type_traits>

#include "cuda/host/execution.h"
#include "cuda/runtime.h"

#define __global__
#define __device__
#define __launch_bounds__(...)
#define PENUMBRA_SHARED(T, name, count) const auto name = penumbra::cuda_on_host::shared_span<T, count>([] {})
#define PENUMBRA_UNROLL
#define PENUMBRA_KERNEL(f)         \
  penumbra::cuda_on_host::Kernel { \
#f, f                          \
  }

namespace penumbra::cuda_on_host {

#define threadIdx penumbra::cuda_on_host::thread_index
#define blockIdx penumbra::cuda_on_host::block_index
#define blockDim penumbra::cuda_on_host::block_size
#define gridDim penumbra::cuda_on_host::grid_size

/// An index that remembers where it was written: operator[] takes no second argument.
struct Place {
  std::size_t i;
  Where where;
  Place(std::size_t index, Where w = Where::current()) : i(index), where(w) {}
};

/// Device memory; not owned; every access is checked.
template <class T>
struct Span {
  T* data = nullptr;
  std::size_t size = 0;
  T& operator[](Place at) const {
    if (at.i >= size) fail("element " + std::to_string(at.i) + " of a span of " + std::to_string(size), at.where);
    note_access(data + at.i, sizeof(T));
    return data[at.i];
  }
  template <std::same_as<const T> U>
  operator Span<U>() const {
    return {data, size};
  }
};

template <class T>
class SharedArray final : public SharedBase {
 public:
  explicit SharedArray(std::size_t count) : values_(new T[count]), count_(count), shadow_(count) {}
  T read(std::size_t i, Where where) {
    check(i, where);
    shadow_.check_read(i, where);
    return values_[i];
  }
  void write(std::size_t i, const T& value, Where where) {
    check(i, where);
    shadow_.check_write(i, where);
    values_[i] = value;
  }

 private:
  void check(std::size_t i, Where where) const {
    if (i >= count_) fail("element " + std::to_string(i) + " of a shared array of " + std::to_string(count_), where);
  }
  std::unique_ptr<T[]> values_;
  std::size_t count_;
  Shadow shadow_;
};

/// An element of shared memory: reads and writes are told apart.
template <class T>
class SharedElement {
 public:
  SharedElement(SharedArray<T>* array, std::size_t i, Where where) : array_(array), i_(i), where_(where) {}
  operator T() const { return array_->read(i_, where_); }
  const SharedElement& operator=(const T& value) const {
    array_->write(i_, value, where_);
    return *this;
  }
  const SharedElement& operator=(const SharedElement& other) const { return *this = T(other); }
  const SharedElement& operator+=(const T& value) const { return *this = T(*this) + value; }
  const SharedElement& operator|=(const T& value) const { return *this = T(T(*this) | value); }

 private:
  SharedArray<T>* array_;
  std::size_t i_;
  Where where_;
};

template <class T>
struct SharedSpan {
  SharedArray<T>* array;
  SharedElement<T> operator[](Place at) const { return {array, at.i, at.where}; }
};

/// `Declaration` is a type of its own for every place in the source.
template <class T, std::size_t count, class Declaration>
SharedSpan<T> shared_span(Declaration) {
  static const char key = 0;
  return {static_cast<SharedArray<T>*>(&shared_memory(&key, [] { return std::make_unique<SharedArray<T>>(count); }))};
}

inline void __syncthreads(Where where = Where::current()) {
  wait_for_block(where);
}
inline void __syncwarp(unsigned mask = ~0u, Where where = Where::current()) {
  wait_for_warp(mask, where);
}

template <class T>
std::uint64_t to_bits(T value) {
  static_assert(std::is_trivially_copyable_v<T> && sizeof(T) <= 8);
  std::uint64_t bits = 0;
  std::memcpy(&bits, &value, sizeof(T));
  return bits;
}
template <class T>
T from_lane(unsigned mask, T value, unsigned lane, const char* what, Where where) {
  const std::uint64_t bits = exchange(mask, to_bits(value), what, where)[lane];
  if (!(mask >> lane & 1u))
    fail(std::string(what) + " reads lane " + std::to_string(lane) + " outside its mask", where);
  std::memcpy(&value, &bits, sizeof(T));
  return value;
}
template <class T>
T __shfl_sync(unsigned mask, T value, unsigned lane, Where where = Where::current()) {
  return from_lane(mask, value, lane % 32, "__shfl_sync", where);
}
template <class T>
T __shfl_xor_sync(unsigned mask, T value, unsigned bits, Where where = Where::current()) {
  return from_lane(mask, value, (thread_index.x ^ bits) % 32, "__shfl_xor_sync", where);
}
template <class T>
T __shfl_down_sync(unsigned mask, T value, unsigned by, Where where = Where::current()) {
  const unsigned lane = thread_index.x % 32;
  return from_lane(mask, value, lane + by < 32 ? lane + by : lane, "__shfl_down_sync", where);
}
inline unsigned __ballot_sync(unsigned mask, bool bit, Where where = Where::current()) {
  const std::uint64_t* all = exchange(mask, bit, "__ballot_sync", where);
  unsigned bits = 0;
  for (unsigned lane = 0; lane < 32; ++lane)
    if (mask >> lane & 1u) bits |= unsigned(all[lane]) << lane;
  return bits;
}
inline bool __any_sync(unsigned mask, bool bit, Where where = Where::current()) {
  return __ballot_sync(mask, bit, where) != 0;
}
inline bool __all_sync(unsigned mask, bool bit, Where where = Where::current()) {
  return __ballot_sync(mask, bit, where) == mask;
}
inline int __popc(unsigned bits) {
  return std::popcount(bits);
}
inline int __ffs(unsigned bits) {
  return bits ? std::countr_zero(bits) + 1 : 0;
}

template <class T>
T atomic_add(const Span<T>& array, std::size_t i, std::type_identity_t<T> value) {
  return std::atomic_ref<T>(array[i]).fetch_add(value, std::memory_order_relaxed);
}

inline void tally(float operations) {
  tally_operations(double(operations));
}

template <class... P>
struct Kernel {
  const char* name;
  void (*function)(P...);
};
template <class... P>
Kernel(const char*, void (*)(P...)) -> Kernel<P...>;

template <class... P, class... A>
void launch(const Stream& stream, const Kernel<P...>& kernel, unsigned blocks, unsigned threads,
            const A&... arguments) {
  if (blocks == 0) return;
  stream.run([=] { run_grid(kernel.name, blocks, threads, [&] { kernel.function(P(arguments)...); }); });
}

}  // namespace penumbra::cuda_on_host
