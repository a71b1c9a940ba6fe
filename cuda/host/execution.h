// Runs kernels on the host, to test them without a device: block by block, each thread a fiber that stops where threads
// must wait for each other. Its time says nothing about a device.
//
// What it catches, as KernelError with kernel, block, thread and source line:
//   - a barrier that not all threads of a block reach, or that they reach in different places;
//   - a warp operation that not all lanes of its mask reach together, or that reads a lane outside it;
//   - reads of shared memory that nobody wrote;
//   - two threads at the same element of shared memory, one of them writing, and no barrier between;
//   - accesses outside of spans and shared arrays.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

namespace penumbra::cuda_on_host {

/// A place in the source. (std::source_location is not known to every compiler that reads this.)
struct Where {
  const char* file;
  unsigned line;
  static constexpr Where current(const char* f = __builtin_FILE(), unsigned l = __builtin_LINE()) { return {f, l}; }
};

class KernelError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// In what order the threads of a block, and the blocks of a grid, take their turns. A right kernel cannot tell.
enum class Order { forward, reversed, shuffled };
void set_order(Order order);

/// What the launches of one kernel did, counted.
struct Counts {
  std::size_t launches = 0, blocks = 0, threads = 0;
  unsigned block_size = 0;
  double operations = 0;         ///< floating-point, as the kernel tallies them
  std::size_t bytes = 0;         ///< of global memory, as threads ask for them
  std::size_t unique_bytes = 0;  ///< the same, every sector of 32 bytes once a launch: what no cache can save
  std::size_t barriers = 0;      ///< times a block waited
};
/// Counting is off at first, since it is slow. Turning it on starts anew.
void count_launches(bool on);
const std::map<std::string, Counts>& counts();

using Body = std::function<void()>;
void run_grid(const char* kernel, unsigned blocks, unsigned threads, const Body& body);

// --- what a kernel sees of its thread --------------------------------------------------------------------------------

struct Index {
  unsigned x = 0, y = 0, z = 0;
};
extern constinit thread_local Index thread_index, block_index, block_size, grid_size;

void wait_for_block(Where where);
/// Hands `bits` to the lanes of `mask` and waits for theirs; the answer holds those of all 32 lanes.
const std::uint64_t* exchange(unsigned mask, std::uint64_t bits, const char* what, Where where);
/// Lanes see each other's shared memory from here on.
void wait_for_warp(unsigned mask, Where where);

/// Throws KernelError: "kernel, block b, thread t: message (file:line)".
[[noreturn]] void fail(const std::string& message, Where where);

void tally_operations(double count);
void note_access(const void* address, std::size_t bytes);

// --- shared memory ---------------------------------------------------------------------------------------------------

/// Who touched an element of shared memory last, and when.
class Shadow {
 public:
  explicit Shadow(std::size_t elements) : marks_(elements) {}
  void check_read(std::size_t i, Where where);
  void check_write(std::size_t i, Where where);

 private:
  struct Touch {
    int thread = -1;  ///< -1: nobody yet
    unsigned block_epoch = 0, warp_epoch = 0;
    bool several_warps = false;
  };
  struct Mark {
    std::uint64_t block = 0;  ///< that the rest is about; another's is forgotten
    Touch write, read;
    bool several_readers = false;
  };
  Mark& mark(std::size_t i);
  static bool ordered(const Touch& before);
  std::vector<Mark> marks_;
};

struct SharedBase {
  virtual ~SharedBase() = default;
};
/// The running block's array for a declaration (`key`); made by `make` when it is first met.
SharedBase& shared_memory(const void* key, const std::function<std::unique_ptr<SharedBase>()>& make);

}  // namespace penumbra::cuda_on_host
