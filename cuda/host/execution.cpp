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

std::string place(Where where) {
  std::string file = where.file;
  return fmt::format("{}:{}", file.substr(file.rfind('/') + 1), where.line);
}

/// One thread of the running block.
struct Thread {
  enum class State { ready, at_barrier, at_warp, done } state = State::ready;
  Where where{"", 0};
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

  void wait(Thread::State state, unsigned mask, std::uint64_t bits, const char* what, Where where) {
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
  std::uint64_t number() const { return number_; }

  SharedBase& shared(const void* key, const std::function<std::unique_ptr<SharedBase>()>& make) {
    auto& array = shared_[key];
    if (!array) array = make();
    return *array;
  }

 private:
  std::size_t free_worker();
  void live(Worker& worker);
  void take(std::size_t worker, unsigned thread);
  void resume(std::size_t worker);
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
  std::size_t barriers_ = 0, done_ = 0;
  std::uint64_t number_ = 0;  ///< of this block among all that ran
  const std::vector<unsigned>* order_ = nullptr;
  std::size_t started_ = 0;  ///< threads of order_ that have begun
  std::exception_ptr failure_;
  std::map<const void*, std::unique_ptr<SharedBase>> shared_;
};

/// A worker's life: runs the thread it is given, then all that have not begun, until it is told to stop.
void Block::live(Worker& worker) {
  for (;;) {
    try {
      (*body_)();
    } catch (const boost::context::detail::forced_unwind&) {
      throw;
    } catch (...) {
      failure_ = std::current_exception();
    }
    threads_[worker.thread].state = Thread::State::done;
    ++done_;
    if (!failure_ && started_ < order_->size()) take(threads_[worker.thread].worker, (*order_)[started_++]);
    else back_ = std::move(back_).resume();
  }
}

std::size_t Block::free_worker() {
  if (free_.empty()) {
    free_.push_back(workers_.size());
    workers_.push_back(std::make_unique<Worker>());
    Worker* worker = workers_.back().get();
    const auto life = [this, worker](boost::context::fiber&& caller) {
      back_ = std::move(caller);
      live(*worker);
      return std::move(back_);
    };
    worker->fiber =
        boost::context::fiber(std::allocator_arg, boost::context::fixedsize_stack(std::size_t(1) << 16), life);
  }
  const std::size_t index = free_.back();
  free_.pop_back();
  return index;
}

/// The thread is the worker's from now on, and the one that runs.
void Block::take(std::size_t worker, unsigned thread) {
  threads_[thread].worker = worker;
  workers_[worker]->thread = thread;
  current_ = thread;
  thread_index = {thread, 0, 0};
}

/// Runs the worker until a thread of it waits, or it has nothing left to run.
void Block::resume(std::size_t worker) {
  Worker& w = *workers_[worker];
  w.fiber = std::move(w.fiber).resume();
  if (threads_[w.thread].state == Thread::State::done) free_.push_back(worker);
  if (!failure_) return;
  workers_.clear(), free_.clear();  // unwinds what still waits
  std::rethrow_exception(failure_);
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
               o.where.line == t.where.line && o.where.file == t.where.file;
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
    if (t.state != Thread::State::at_barrier || t.where.line != threads_[0].where.line) return false;
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
    if (threads_[k].state != threads_[0].state || threads_[k].where.line != threads_[0].where.line) other = k;
  throw KernelError(fmt::format("{}, block {}: divergent: {}, but {}", kernel_, block_index.x, describe(0),
                                other ? describe(other) : std::string("lanes of its mask are missing")));
}

void Block::run(const char* kernel, unsigned threads, const Body& body, const std::vector<unsigned>& order) {
  kernel_ = kernel, body_ = &body, order_ = &order;
  threads_.assign(threads, {});
  warps_.assign((threads + warp_size - 1) / warp_size, {});
  epoch_ = 0, barriers_ = 0, done_ = 0, started_ = 0;
  ++number_;
  failure_ = nullptr;
  while (started_ < threads) {
    const std::size_t worker = free_worker();
    take(worker, order[started_++]);
    resume(worker);
  }
  while (done_ < threads) {
    if (!release_warps() && !release_block()) {
      workers_.clear(), free_.clear();
      stuck();
    }
    for (const unsigned t : order) {
      if (threads_[t].state != Thread::State::ready) continue;
      take(threads_[t].worker, t);
      resume(threads_[t].worker);
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

void wait_for_block(Where where) {
  block->wait(Thread::State::at_barrier, 0, 0, "__syncthreads", where);
}

const std::uint64_t* exchange(unsigned mask, std::uint64_t bits, const char* what, Where where) {
  if (!(mask >> (thread_index.x % warp_size) & 1u))
    fail(fmt::format("{}: the mask leaves its caller out", what), where);
  block->wait(Thread::State::at_warp, mask, bits, what, where);
  return block->answer();
}

void wait_for_warp(unsigned mask, Where where) {
  exchange(mask, 0, "__syncwarp", where);
}

void fail(const std::string& message, Where where) {
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

Shadow::Mark& Shadow::mark(std::size_t i) {
  if (marks_[i].block != block->number()) marks_[i] = {block->number(), {}, {}, false};
  return marks_[i];
}

/// Does a barrier of the block or of the warp lie between then and now?
bool Shadow::ordered(const Touch& before) {
  if (before.thread < 0 || before.block_epoch != block->epoch()) return true;
  if (before.several_warps || unsigned(before.thread) / warp_size != block->current() / warp_size) return false;
  return before.warp_epoch != block->warp_epoch();
}

void Shadow::check_read(std::size_t i, Where where) {
  Mark& own = mark(i);
  const int me = int(block->current());
  if (own.write.thread < 0) fail(fmt::format("reads shared element {}, which nobody has written", i), where);
  if (own.write.thread != me && !ordered(own.write))
    fail(fmt::format("reads shared element {}, which thread {} wrote, without a barrier between", i, own.write.thread),
         where);
  const bool besides = !ordered(own.read);  // reads that the same write would have to wait for
  const bool other_warp =
      besides && (own.read.several_warps || unsigned(own.read.thread) / warp_size != block->current() / warp_size);
  own.several_readers = besides && (own.several_readers || own.read.thread != me);
  own.read = {me, block->epoch(), block->warp_epoch(), other_warp};
}

void Shadow::check_write(std::size_t i, Where where) {
  Mark& own = mark(i);
  const int me = int(block->current());
  if (own.write.thread != me && !ordered(own.write))
    fail(fmt::format("writes shared element {}, which thread {} wrote, without a barrier between", i, own.write.thread),
         where);
  if ((own.several_readers || own.read.thread != me) && !ordered(own.read))
    fail(fmt::format("writes shared element {}, which thread {} read, without a barrier between", i, own.read.thread),
         where);
  own.write = {me, block->epoch(), block->warp_epoch(), false};
}

}  // namespace penumbra::cuda_on_host
