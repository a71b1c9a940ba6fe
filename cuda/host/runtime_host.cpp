#include "cuda/host/runtime_host.h"

#include <fmt/format.h>

#include <cstdlib>
#include <limits>
#include <map>
#include <mutex>

namespace penumbra::cuda_on_host {
namespace {

std::mutex guard;
std::size_t limit = std::numeric_limits<std::size_t>::max(), used = 0;
std::map<void*, std::size_t> sizes;

}  // namespace

void set_memory_limit(std::size_t bytes) {
  const std::lock_guard lock(guard);
  limit = bytes;
}

void* allocate(std::size_t bytes) {
  const std::lock_guard lock(guard);
  if (bytes > limit || used > limit - bytes)
    throw DeviceError(fmt::format("out of device memory: {} MiB wanted, {} of {} MiB are free", bytes >> 20,
                                  (limit - std::min(used, limit)) >> 20, limit >> 20));
  void* memory = std::malloc(bytes);
  if (!memory) throw std::bad_alloc();
  std::memset(memory, 0xff, bytes);
  used += bytes;
  sizes[memory] = bytes;
  return memory;
}

void release(void* memory) noexcept {
  const std::lock_guard lock(guard);
  const auto at = sizes.find(memory);
  if (at == sizes.end()) return;
  used -= at->second;
  sizes.erase(at);
  std::free(memory);
}

}  // namespace penumbra::cuda_on_host
