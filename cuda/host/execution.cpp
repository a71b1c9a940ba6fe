#include "cuda/host/execution.h"

#include <fmt/format.h>

#include <algorithm>
#include <boost/context/fiber.hpp>
#include <numeric>
#include <random>
#include <unordered_set>

namespace penumbra::cuda_on_host {

constinit thread_local Index thread_index, block_index, block_size, grid_size;

namespace {

constexpr unsigned warp_size = 32;

std::string place(std::source_location where) {
  std::string file = where.file_name();
  return fmt::format("{}:{}", file.substr(file.rfind('/') + 1), where.line());
}

/// One thread of the running block.
struct Thread {
  enum class State { ready, at_barrier, at_warp, done } state = State::ready;
  std::source_location where;
  const char* what = "";
  unsigned mask = 0;
  std::uint64_t bits = 0;
  std::size_t worker = 0;
};

struct Warp {
  std::uint64_t answer[warp_size] = {};
  unsigned epoch = 0;  ///< counts what orders shared memory within the warp
};

/// A fiber that runs threads, one after the other, and is given away while its thread waits.
struct Worker {
  boost::context::fiber fiber;
  unsigned thread = 0;
};

/// Everything about the running block. One per thread of the operating system.
class Block {
 public:
  void run(const char* kernel, unsigned threads, const Body& body, const std::vector<unsigned>& order);

  void wait(Thread::State state, unsigned mask, std::uint64_t bits, const char* what, std::source_location where) {
    Thread& t = threads_[current_];
    t.state = state, t.mask = mask, t.bits = bits, t.what = what, t.where = where;
    back_ = std::move(back_).resume();
  }
  const std::uint64_t* answer() const { return warps_[current_ / warp_size].answer; }
  unsigned current() const { return current_; }
  unsigned epoch() const { return epoch_; }
  unsigned warp_epoch() const { return warps_[current_ / warp_size].epoch; }
  const char* kernel() const { return kernel_; }
  std::size_t barriers() const { return barriers_; }

  SharedBase& shared(const void* key, const std::function<std::unique_ptr<SharedBase>()>& make) {
    auto& array = shared_[key];
    if (!array) array = make();
    return *array;
  }

 private:
  std::size_t free_worker();
  void resume(unsigned thread, const Body& body);
  bool release_warps();
  bool release_block();
  [[noreturn]] void stuck() const;
  std::string describe(unsigned thread) const;

  const char* kernel_ = "";
  const Body* body_ = nullptr;
  std::vector<Thread> threads_;
  std::vector<Warp> warps_;
  std::vector<std::unique_ptr<Worker>> workers_;
  std::vector<std::size_t> free_;
  boost::context::fiber back_;  ///< to whoever resumed the running fiber
  unsigned current_ = 0, epoch_ = 0;
  std::size_t barriers_ = 0;
  std::exception_ptr failure_;
  std::map<const void*, std::unique_ptr<SharedBase>> shared_;
};

/// A worker's life: runs the thread it is given, says that it is done, and waits for the next.
std::size_t Block::free_worker() {
  if (free_.empty()) {
    const std::size_t index = workers_.size();
    workers_.push_back(std::make_unique<Worker>());
    Worker* worker = workers_.back().get();
    const auto life = [this, worker](boost::context::fiber&& caller) {
      back_ = std::move(caller);
      for (;;) {
        const unsigned thread = worker->thread;
        try {
          (*body_)();
        } catch (const boost::context::detail::forced_unwind&) {
          throw;
        } catch (...) {
          failure_ = std::current_exception();
        }
        threads_[thread].state = Thread::State::done;
        back_ = std::move(back_).resume();
      }
      return std::move(back_);
    };
    worker->fiber =
        boost::context::fiber(std::allocator_arg, boost::context::fixedsize_stack(std::size_t(1) << 16), life);
    free_.push_back(index);
  }
  const std::size_t index = free_.back();
  free_.pop_back();
  return index;
}

void Block::resume(unsigned thread, const Body& body) {
  body_ = &body;
  current_ = thread;
  thread_index = {thread, 0, 0};
  Worker& worker = *workers_[threads_[thread].worker];
  worker.thread = thread;
  worker.fiber = std::move(worker.fiber).resume();
  if (threads_[thread].state == Thread::State::done) free_.push_back(threads_[thread].worker);
}

/// Lanes whose operation all lanes of its mask have reached go on.
bool Block::release_warps() {
  bool any = false;
  for (unsigned first = 0; first < threads_.size(); first += warp_size) {
    const unsigned lanes = std::min<unsigned>(warp_size, unsigned(threads_.size()) - first);
    for (unsigned lane = 0; lane < lanes; ++lane) {
      const Thread& t = threads_[first + lane];
      if (t.state != Thread::State::at_warp) continue;
      const auto together = [&](unsigned other) {
        if (other >= lanes) return false;
        const Thread& o = threads_[first + other];
        return o.state == Thread::State::at_warp && o.mask == t.mask && o.what == t.what &&
               o.where.line() == t.where.line() && o.where.file_name() == t.where.file_name();
      };
      bool all = true;
      for (unsigned other = 0; other < warp_size; ++other)
        if (t.mask >> other & 1u) all &= together(other);
      if (!all) continue;
      Warp& warp = warps_[first / warp_size];
      const unsigned mask = t.mask;
      warp.epoch += t.what == std::string_view("__syncwarp");
      for (unsigned other = 0; other < warp_size; ++other)
        if (mask >> other & 1u) {
          warp.answer[other] = threads_[first + other].bits;
          threads_[first + other].state = Thread::State::ready;
        }
      any = true;
    }
  }
  return any;
}

bool Block::release_block() {
  for (const Thread& t : threads_)
    if (t.state != Thread::State::at_barrier || t.where.line() != threads_[0].where.line()) return false;
  for (Thread& t : threads_) t.state = Thread::State::ready;
  ++epoch_, ++barriers_;
  return true;
}

std::string Block::describe(unsigned thread) const {
  const Thread& t = threads_[thread];
  if (t.state == Thread::State::done) return fmt::format("thread {} has ended", thread);
  return fmt::format("thread {} waits in {} at {}", thread, t.what, place(t.where));
}

void Block::stuck() const {
  unsigned other = 0;
  for (unsigned k = 1; k < threads_.size() && other == 0; ++k)
    if (threads_[k].state != threads_[0].state || threads_[k].where.line() != threads_[0].where.line()) other = k;
  throw KernelError(fmt::format("{}, block {}: divergent: {}, but {}", kernel_, block_index.x, describe(0),
                                other ? describe(other) : std::string("lanes of its mask are missing")));
}

void Block::run(const char* kernel, unsigned threads, const Body& body, const std::vector<unsigned>& order) {
  kernel_ = kernel;
  threads_.assign(threads, {});
  warps_.assign((threads + warp_size - 1) / warp_size, {});
  epoch_ = 0, barriers_ = 0;
  failure_ = nullptr;
  for (auto& [key, array] : shared_) array->forget();
  bool started = false;
  for (std::size_t left = threads; left > 0;) {
    for (const unsigned t : order) {
      if (threads_[t].state != Thread::State::ready) continue;
      if (!started) threads_[t].worker = free_worker();
      resume(t, body);
      left -= threads_[t].state == Thread::State::done;
      if (!failure_) continue;
      workers_.clear(), free_.clear();  // unwinds what still waits
      std::rethrow_exception(failure_);
    }
    started = true;
    if (left > 0 && !release_warps() && !release_block()) {
      try {
        stuck();
      } catch (...) {
        workers_.clear(), free_.clear();
        throw;
      }
    }
  }
}

thread_local Block running;
constinit thread_local Block* block = nullptr;  ///< &running, without asking whether it exists yet
Order order_of_turns = Order::forward;
bool counting = false;
std::map<std::string, Counts> counted;
Counts* current_counts = nullptr;
std::unordered_set<std::uintptr_t> sectors;

/// 0 to count - 1 in the order that is asked for.
std::vector<unsigned> turns(unsigned count) {
  std::vector<unsigned> order(count);
  std::iota(order.begin(), order.end(), 0u);
  if (order_of_turns == Order::reversed) std::reverse(order.begin(), order.end());
  if (order_of_turns == Order::shuffled) {
    std::mt19937 random(count);
    std::shuffle(order.begin(), order.end(), random);
  }
  return order;
}

}  // namespace

void set_order(Order order) {
  order_of_turns = order;
}

void count_launches(bool on) {
  counting = on;
  if (on) counted.clear();
  current_counts = nullptr;
}

const std::map<std::string, Counts>& counts() {
  return counted;
}

void run_grid(const char* kernel, unsigned blocks, unsigned threads, const Body& body) {
  if (threads == 0 || threads > 1024)
    throw KernelError(fmt::format("{}: {} threads a block; must be 1 to 1024", kernel, threads));
  block_size = {threads, 1, 1}, grid_size = {blocks, 1, 1};
  if (counting) {
    current_counts = &counted[kernel];
    ++current_counts->launches;
    current_counts->blocks += blocks, current_counts->threads += std::size_t(blocks) * threads;
    current_counts->block_size = threads;
    sectors.clear();
  }
  block = &running;
  const std::vector<unsigned> order = turns(threads);
  for (const unsigned b : turns(blocks)) {
    block_index = {b, 0, 0};
    block->run(kernel, threads, body, order);
    if (counting) current_counts->barriers += block->barriers();
  }
  if (counting) current_counts->unique_bytes += 32 * sectors.size();
}

void wait_for_block(std::source_location where) {
  block->wait(Thread::State::at_barrier, 0, 0, "__syncthreads", where);
}

const std::uint64_t* exchange(unsigned mask, std::uint64_t bits, const char* what, std::source_location where) {
  if (!(mask >> (thread_index.x % warp_size) & 1u))
    fail(fmt::format("{}: the mask leaves its caller out", what), where);
  block->wait(Thread::State::at_warp, mask, bits, what, where);
  return block->answer();
}

void wait_for_warp(unsigned mask, std::source_location where) {
  exchange(mask, 0, "__syncwarp", where);
}

void fail(const std::string& message, std::source_location where) {
  throw KernelError(fmt::format("{}, block {}, thread {}: {} ({})", block->kernel(), block_index.x, thread_index.x,
                                message, place(where)));
}

void tally_operations(double count) {
  if (counting) current_counts->operations += count;
}

void note_access(const void* address, std::size_t bytes) {
  if (!counting) return;
  current_counts->bytes += bytes;
  const auto first = reinterpret_cast<std::uintptr_t>(address) / 32;
  const auto last = (reinterpret_cast<std::uintptr_t>(address) + bytes - 1) / 32;
  for (auto sector = first; sector <= last; ++sector) sectors.insert(sector);
}

// --- shared memory ---------------------------------------------------------------------------------------------------

SharedBase& shared_memory(const void* key, const std::function<std::unique_ptr<SharedBase>()>& make) {
  return block->shared(key, make);
}

void Shadow::forget() {
  std::fill(marks_.begin(), marks_.end(), Mark{});
}

/// Does a barrier of the block or of the warp lie between then and now?
bool Shadow::ordered(const Touch& before) {
  if (before.thread < 0 || before.block_epoch != block->epoch()) return true;
  if (before.several_warps || unsigned(before.thread) / warp_size != block->current() / warp_size) return false;
  return before.warp_epoch != block->warp_epoch();
}

void Shadow::check_read(std::size_t i, std::source_location where) {
  Mark& mark = marks_[i];
  const int me = int(block->current());
  if (mark.write.thread < 0) fail(fmt::format("reads shared element {}, which nobody has written", i), where);
  if (mark.write.thread != me && !ordered(mark.write))
    fail(fmt::format("reads shared element {}, which thread {} wrote, without a barrier between", i, mark.write.thread),
         where);
  const bool besides = !ordered(mark.read);  // reads that the same write would have to wait for
  const bool other_warp =
      besides && (mark.read.several_warps || unsigned(mark.read.thread) / warp_size != block->current() / warp_size);
  mark.several_readers = besides && (mark.several_readers || mark.read.thread != me);
  mark.read = {me, block->epoch(), block->warp_epoch(), other_warp};
}

void Shadow::check_write(std::size_t i, std::source_location where) {
  Mark& mark = marks_[i];
  const int me = int(block->current());
  if (mark.write.thread != me && !ordered(mark.write))
    fail(
        fmt::format("writes shared element {}, which thread {} wrote, without a barrier between", i, mark.write.thread),
        where);
  if ((mark.several_readers || mark.read.thread != me) && !ordered(mark.read))
    fail(fmt::format("writes shared element {}, which thread {} read, without a barrier between", i, mark.read.thread),
         where);
  mark.write = {me, block->epoch(), block->warp_epoch(), false};
}

}  // namespace penumbra::cuda_on_host
