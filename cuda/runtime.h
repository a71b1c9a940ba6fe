// Device memory, streams, events and graphs, each with its owner. On the host (`cuda_on_host`) memory is the host's,
// streams run at once, and events take no time.
#pragma once

#include <cstddef>
#include <span>
#include <stdexcept>
#include <vector>

#ifdef __CUDACC__
#define PENUMBRA_CUDA_NAMESPACE cuda
#include "cuda/runtime_device.h"
#else
#define PENUMBRA_CUDA_NAMESPACE cuda_on_host
#include "cuda/host/runtime_host.h"
#endif

namespace penumbra::PENUMBRA_CUDA_NAMESPACE {

template <class T>
struct Span;

/// An array in device memory. Moves, does not copy.
template <class T>
class Buffer {
 public:
  Buffer() = default;
  Buffer(Buffer&& other) noexcept { swap(other); }
  Buffer& operator=(Buffer&& other) noexcept {
    swap(other);
    return *this;
  }
  ~Buffer() { release(data_); }

  /// Makes room for so many elements; contents are lost if it grows. Throws DeviceError where memory runs out.
  void resize(std::size_t count) {
    if (count > capacity_) {
      release(data_);
      data_ = nullptr, capacity_ = size_ = 0;  // should the next line throw
      data_ = static_cast<T*>(allocate(count * sizeof(T)));
      capacity_ = count;
    }
    size_ = count;
  }
  /// Copies all to the device. `values` may go when this returns: what is not pinned is staged first.
  void upload(const Stream& stream, std::span<const T> values) {
    resize(values.size());
    copy_to_device(stream, data_, values.data(), values.size_bytes());
  }
  void upload(const Stream& stream, const std::vector<T>& values) { upload(stream, std::span<const T>(values)); }
  /// Copies all to the host, and waits for the stream.
  void download(const Stream& stream, T* to) const {
    copy_to_host(stream, to, data_, size_ * sizeof(T));
    stream.wait();
  }

  std::size_t size() const { return size_; }
  std::size_t bytes() const { return capacity_ * sizeof(T); }
  Span<T> span() { return {data_, size_}; }
  Span<const T> span() const { return {data_, size_}; }

 private:
  void swap(Buffer& other) noexcept {
    std::swap(data_, other.data_), std::swap(size_, other.size_), std::swap(capacity_, other.capacity_);
  }
  T* data_ = nullptr;
  std::size_t size_ = 0, capacity_ = 0;
};

}  // namespace penumbra::PENUMBRA_CUDA_NAMESPACE
