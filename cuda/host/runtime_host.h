// runtime.h on the host.
#pragma once

#include <cstring>
#include <functional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace penumbra::cuda_on_host {

class DeviceError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Runs what it is given at once, or hands it to the graph that captures it.
class Stream {
 public:
  void wait() const {}
  void run(std::function<void()> work) const {
    if (capture_) capture_->push_back(std::move(work));
    else work();
  }

 private:
  friend class Graph;
  mutable std::vector<std::function<void()>>* capture_ = nullptr;
};

class Event {
 public:
  void record(const Stream&) {}
  static double milliseconds(const Event&, const Event&) { return 0.0; }
};

/// Memory that pretends to be a device's: at most `limit` bytes at a time, and full of values that are not numbers.
void set_memory_limit(std::size_t limit);
void* allocate(std::size_t bytes);
void release(void* memory) noexcept;
inline void copy_to_device(const Stream&, void* to, const void* from, std::size_t bytes) {
  if (bytes > 0) std::memcpy(to, from, bytes);
}
inline void copy_to_host(const Stream&, void* to, const void* from, std::size_t bytes) {
  if (bytes > 0) std::memcpy(to, from, bytes);
}

class Graph {
 public:
  template <class Launches>
  void run(const Stream& stream, const Launches& launches) {
    if (!captured_) {
      work_.clear();
      stream.capture_ = &work_;
      try {
        launches();
      } catch (...) {
        stream.capture_ = nullptr;
        throw;
      }
      stream.capture_ = nullptr;
      captured_ = true;
    }
    for (const auto& work : work_) work();
  }
  void forget() noexcept { captured_ = false; }

 private:
  std::vector<std::function<void()>> work_;
  bool captured_ = false;
};

}  // namespace penumbra::cuda_on_host
