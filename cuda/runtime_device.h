// runtime.h on the device.
#pragma once

#include <cuda_runtime.h>

#include <map>
#include <source_location>
#include <stdexcept>
#include <string>
#include <utility>

namespace penumbra::cuda {

/// "file:line: what: CUDA's text".
class DeviceError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};
/// Throws DeviceError unless the code is cudaSuccess.
void check(cudaError_t code, const char* what, std::source_location where = std::source_location::current());

class Stream {
 public:
  Stream();
  ~Stream();
  Stream(const Stream&) = delete;
  Stream& operator=(const Stream&) = delete;
  cudaStream_t handle() const { return handle_; }
  void wait() const;

 private:
  cudaStream_t handle_ = nullptr;
};

class Event {
 public:
  Event();
  ~Event();
  Event(const Event&) = delete;
  Event& operator=(const Event&) = delete;
  void record(const Stream& stream);
  /// Time between two events. Waits for the later one.
  static double milliseconds(const Event& from, const Event& to);

 private:
  cudaEvent_t handle_ = nullptr;
};

void* allocate(std::size_t bytes);
void release(void* memory) noexcept;
void copy_to_device(const Stream& stream, void* to, const void* from, std::size_t bytes);
void copy_to_host(const Stream& stream, void* to, const void* from, std::size_t bytes);

/// Launches that are captured once and replayed: one call to the driver for many kernels.
class Graph {
 public:
  Graph() = default;
  ~Graph() { forget(); }
  Graph(const Graph&) = delete;
  Graph& operator=(const Graph&) = delete;

  template <class Launches>
  void run(const Stream& stream, const Launches& launches) {
    if (profiling()) return launches();
    if (!executable_) {
      begin(stream);
      try {
        launches();
      } catch (...) {
        abandon(stream);
        throw;
      }
      end(stream);
    }
    replay(stream);
  }
  /// For changed arguments: the next run() captures anew.
  void forget() noexcept;

 private:
  static bool profiling();
  void begin(const Stream& stream);
  void end(const Stream& stream);
  void abandon(const Stream& stream) noexcept;
  void replay(const Stream& stream);
  cudaGraphExec_t executable_ = nullptr;
};

/// Times every kernel by events of its own while profiling is on; graphs are then not used.
void profile_kernels(bool on);
struct KernelTime {
  double ms = 0.0;
  std::size_t launches = 0;
};
/// Sums by kernel since profiling was turned on. Waits for the device.
std::map<std::string, KernelTime> kernel_times();

/// Lives around a launch.
class KernelTimer {
 public:
  KernelTimer(const Stream& stream, const char* name);
  ~KernelTimer() noexcept(false);

 private:
  const Stream& stream_;
  std::size_t index_;
};

}  // namespace penumbra::cuda
