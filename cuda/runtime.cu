#include "cuda/runtime.h"

#include <memory>
#include <vector>

namespace penumbra::cuda {

void check(cudaError_t code, const char* what, std::source_location where) {
  if (code == cudaSuccess) return;
  cudaGetLastError();  // the next call starts clean, if it can
  const std::string file = where.file_name();
  throw DeviceError(file.substr(file.rfind('/') + 1) + ":" + std::to_string(where.line()) + ": " + what + ": " +
                    cudaGetErrorString(code));
}

Stream::Stream() {
  check(cudaStreamCreateWithFlags(&handle_, cudaStreamNonBlocking), "cudaStreamCreate");
}
Stream::~Stream() {
  cudaStreamDestroy(handle_);
}
void Stream::wait() const {
  check(cudaStreamSynchronize(handle_), "cudaStreamSynchronize");
}

Event::Event() {
  check(cudaEventCreate(&handle_), "cudaEventCreate");
}
Event::~Event() {
  cudaEventDestroy(handle_);
}
void Event::record(const Stream& stream) {
  check(cudaEventRecord(handle_, stream.handle()), "cudaEventRecord");
}
double Event::milliseconds(const Event& from, const Event& to) {
  check(cudaEventSynchronize(to.handle_), "cudaEventSynchronize");
  float ms = 0.0f;
  check(cudaEventElapsedTime(&ms, from.handle_, to.handle_), "cudaEventElapsedTime");
  return double(ms);
}

void* allocate(std::size_t bytes) {
  void* memory = nullptr;
  const cudaError_t code = cudaMalloc(&memory, bytes);
  if (code != cudaErrorMemoryAllocation) {
    check(code, "cudaMalloc");
    return memory;
  }
  cudaGetLastError();
  std::size_t free = 0, all = 0;
  cudaMemGetInfo(&free, &all);
  const auto mebibytes = [](std::size_t b) { return std::to_string(b >> 20); };
  throw DeviceError("out of device memory: " + mebibytes(bytes) + " MiB wanted, " + mebibytes(free) + " of " +
                    mebibytes(all) + " MiB are free");
}
void release(void* memory) noexcept {
  cudaFree(memory);
}
void copy_to_device(const Stream& stream, void* to, const void* from, std::size_t bytes) {
  check(cudaMemcpyAsync(to, from, bytes, cudaMemcpyHostToDevice, stream.handle()), "cudaMemcpyAsync to the device");
}
void copy_to_host(const Stream& stream, void* to, const void* from, std::size_t bytes) {
  check(cudaMemcpyAsync(to, from, bytes, cudaMemcpyDeviceToHost, stream.handle()), "cudaMemcpyAsync to the host");
}

// --- graphs ----------------------------------------------------------------------------------------------------------

void Graph::begin(const Stream& stream) {
  check(cudaStreamBeginCapture(stream.handle(), cudaStreamCaptureModeThreadLocal), "cudaStreamBeginCapture");
}
void Graph::end(const Stream& stream) {
  cudaGraph_t graph = nullptr;
  check(cudaStreamEndCapture(stream.handle(), &graph), "cudaStreamEndCapture");
  const cudaError_t code = cudaGraphInstantiate(&executable_, graph, 0);
  cudaGraphDestroy(graph);
  check(code, "cudaGraphInstantiate");
}
void Graph::abandon(const Stream& stream) noexcept {
  cudaGraph_t graph = nullptr;
  cudaStreamEndCapture(stream.handle(), &graph);
  if (graph) cudaGraphDestroy(graph);
}
void Graph::replay(const Stream& stream) {
  check(cudaGraphLaunch(executable_, stream.handle()), "cudaGraphLaunch");
}
void Graph::forget() noexcept {
  if (executable_) cudaGraphExecDestroy(executable_);
  executable_ = nullptr;
}

// --- times of single kernels -----------------------------------------------------------------------------------------

namespace {

struct Timed {
  const char* name;
  Event from, to;
};
bool profiling_on = false;
std::vector<std::unique_ptr<Timed>> timed;

}  // namespace

bool Graph::profiling() {
  return profiling_on;
}

void profile_kernels(bool on) {
  profiling_on = on;
  if (on) timed.clear();
}

std::map<std::string, KernelTime> kernel_times() {
  std::map<std::string, KernelTime> times;
  for (const auto& t : timed) {
    KernelTime& sum = times[t->name];
    sum.ms += Event::milliseconds(t->from, t->to);
    ++sum.launches;
  }
  return times;
}

KernelTimer::KernelTimer(const Stream& stream, const char* name) : stream_(stream), index_(timed.size()) {
  if (!profiling_on) return;
  timed.push_back(std::make_unique<Timed>());
  timed.back()->name = name;
  timed.back()->from.record(stream);
}
KernelTimer::~KernelTimer() noexcept(false) {
  if (profiling_on) timed[index_]->to.record(stream_);
}

}  // namespace penumbra::cuda
