// The host execution of kernels catches what a device would let pass.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "cuda/kernel.h"

namespace penumbra::cuda_on_host {
namespace {

using testing::HasSubstr;

/// The message of the KernelError that a launch throws; empty if it throws none.
template <class... P, class... A>
std::string failure_of(const Kernel<P...>& kernel, unsigned blocks, unsigned threads, const A&... arguments) {
  try {
    launch(Stream(), kernel, blocks, threads, arguments...);
  } catch (const KernelError& e) {
    return e.what();
  }
  return "";
}

class HostExecution : public testing::TestWithParam<Order> {
 protected:
  HostExecution() { set_order(GetParam()); }
  ~HostExecution() override { set_order(Order::forward); }
};
INSTANTIATE_TEST_SUITE_P(EveryOrder, HostExecution, testing::Values(Order::forward, Order::reversed, Order::shuffled));

// --- right kernels ---------------------------------------------------------------------------------------------------

__global__ void sum_blocks(Span<const float> in, Span<float> out) {
  PENUMBRA_SHARED(float, scratch, 3);
  const std::size_t i = global_thread();
  const float sum = block_sum(i < in.size ? in[i] : 0.0f, scratch, 3);
  if (threadIdx.x == 0) out[blockIdx.x] = sum;
}

TEST_P(HostExecution, BarriersShufflesAndSharedMemoryMakeASum) {
  std::vector<float> values(200);
  std::iota(values.begin(), values.end(), 1.0f);
  const Stream stream;
  Buffer<float> in, out;
  in.upload(stream, values);
  out.resize(3);
  launch(stream, PENUMBRA_KERNEL(sum_blocks), blocks_for(values.size(), 96), 96, in.span(), out.span());
  std::vector<float> sums(3);
  out.download(stream, sums.data());
  EXPECT_EQ(sums, (std::vector<float>{96 * 97 / 2, 192 * 193 / 2 - 96 * 97 / 2, 200 * 201 / 2 - 192 * 193 / 2}));
}

__global__ void use_warp(Span<unsigned> out) {
  const unsigned lane = threadIdx.x % 32;
  unsigned* const row = &out[threadIdx.x * 6];
  row[0] = __ballot_sync(all_lanes, lane % 3 == 0);
  row[1] = __shfl_sync(all_lanes, lane * lane, 5);
  row[2] = __shfl_down_sync(all_lanes, lane, 4);
  row[3] = __shfl_xor_sync(all_lanes, lane, 9);
  row[4] = __any_sync(all_lanes, lane == 31);
  row[5] = __all_sync(all_lanes, lane < 31);
}

TEST_P(HostExecution, WarpOperationsAnswerAsOnADevice) {
  const Stream stream;
  Buffer<unsigned> out;
  out.resize(64 * 6);
  launch(stream, PENUMBRA_KERNEL(use_warp), 1, 64, out.span());
  std::vector<unsigned> all(out.size());
  out.download(stream, all.data());
  for (unsigned t = 0; t < 64; ++t) {
    const unsigned lane = t % 32;
    const std::vector<unsigned> row(all.begin() + t * 6, all.begin() + t * 6 + 6);
    EXPECT_EQ(row, (std::vector<unsigned>{0x49249249u, 25, lane < 28 ? lane + 4 : lane, lane ^ 9, 1, 0})) << t;
  }
}

__global__ void count_odd(Span<unsigned> count) {
  if (global_thread() % 2 == 1) atomic_add(count, 0, 1u);
}

TEST_P(HostExecution, AtomicsAddUp) {
  const Stream stream;
  Buffer<unsigned> count;
  count.upload(stream, std::vector<unsigned>{0});
  launch(stream, PENUMBRA_KERNEL(count_odd), 7, 64, count.span());
  unsigned found = 0;
  count.download(stream, &found);
  EXPECT_EQ(found, 7u * 32u);
}

__global__ void neighbours_in_warp(Span<unsigned> out, bool wait) {
  PENUMBRA_SHARED(unsigned, values, 64);
  const unsigned t = threadIdx.x;
  values[t] = t;
  if (wait) __syncwarp();
  out[t] = values[t / 32 * 32 + (t + 1) % 32];
}

TEST_P(HostExecution, WarpBarriersOrderSharedMemoryWithinAWarp) {
  Buffer<unsigned> out;
  out.resize(64);
  EXPECT_EQ(failure_of(PENUMBRA_KERNEL(neighbours_in_warp), 1, 64, out.span(), true), "");
  EXPECT_THAT(failure_of(PENUMBRA_KERNEL(neighbours_in_warp), 1, 64, out.span(), false), HasSubstr("shared element"));
}

// --- wrong kernels ---------------------------------------------------------------------------------------------------

/// Turns a block's values around. Without its barrier the forward order reads what nobody has written, or what was.
__global__ void turn_around(Span<unsigned> out, bool wait) {
  PENUMBRA_SHARED(unsigned, values, 64);
  values[threadIdx.x] = threadIdx.x;
  if (wait) __syncthreads();
  out[threadIdx.x] = values[63 - threadIdx.x];
}

TEST_P(HostExecution, ARemovedBarrierIsCaught) {
  Buffer<unsigned> out;
  out.resize(64);
  EXPECT_EQ(failure_of(PENUMBRA_KERNEL(turn_around), 1, 64, out.span(), true), "");
  const std::string message = failure_of(PENUMBRA_KERNEL(turn_around), 1, 64, out.span(), false);
  EXPECT_THAT(message, HasSubstr("turn_around, block 0, thread"));
  EXPECT_THAT(message, HasSubstr("shared element"));
  EXPECT_THAT(message, HasSubstr("host_execution_test.cpp:"));
}

/// Reads a value and, without a barrier between, overwrites it: right in the forward order, by luck.
__global__ void read_then_write(Span<unsigned> out, bool wait) {
  PENUMBRA_SHARED(unsigned, values, 64);
  values[threadIdx.x] = threadIdx.x;
  __syncthreads();
  out[threadIdx.x] = values[(threadIdx.x + 1) % 64];
  if (wait) __syncthreads();
  values[threadIdx.x] = 0;
}

TEST_P(HostExecution, WritingWhatOthersStillReadIsCaught) {
  Buffer<unsigned> out;
  out.resize(64);
  EXPECT_EQ(failure_of(PENUMBRA_KERNEL(read_then_write), 1, 64, out.span(), true), "");
  EXPECT_THAT(failure_of(PENUMBRA_KERNEL(read_then_write), 1, 64, out.span(), false),
              HasSubstr("without a barrier between"));
}

__global__ void diverge(int how) {
  if (how == 0 && threadIdx.x < 16) __syncthreads();
  if (how == 1) {
    if (threadIdx.x < 16) __syncthreads();
    else __syncthreads();  // another place
  }
  if (how == 2 && threadIdx.x != 3) __shfl_sync(all_lanes, 1, 0);
  if (how == 3 && threadIdx.x < 16) __shfl_sync(0xffffu, 1, 20);
  if (how == 4) __ballot_sync(2u, true);
}

TEST_P(HostExecution, DivergentBarriersAndWarpOperationsAreCaught) {
  EXPECT_THAT(failure_of(PENUMBRA_KERNEL(diverge), 1, 64, 0), HasSubstr("divergent: thread 0 waits in __syncthreads"));
  EXPECT_THAT(failure_of(PENUMBRA_KERNEL(diverge), 1, 64, 0), HasSubstr("has ended"));
  EXPECT_THAT(failure_of(PENUMBRA_KERNEL(diverge), 1, 64, 1), HasSubstr("divergent"));
  EXPECT_THAT(failure_of(PENUMBRA_KERNEL(diverge), 1, 32, 2), HasSubstr("__shfl_sync"));
  EXPECT_THAT(failure_of(PENUMBRA_KERNEL(diverge), 1, 32, 3), HasSubstr("reads lane 20 outside its mask"));
  EXPECT_THAT(failure_of(PENUMBRA_KERNEL(diverge), 1, 32, 4), HasSubstr("leaves its caller out"));
  EXPECT_EQ(failure_of(PENUMBRA_KERNEL(diverge), 1, 64, 9), "") << "the next launch starts clean";
}

__global__ void reach_out(Span<unsigned> values, unsigned i) {
  values[i] = 1;
}
__global__ void reach_out_of_shared(unsigned i) {
  PENUMBRA_SHARED(unsigned, values, 64);
  values[i] = 1;
}
__global__ void read_unwritten(Span<unsigned> out) {
  PENUMBRA_SHARED(unsigned, values, 64);
  if (threadIdx.x < 63) values[threadIdx.x] = 1;
  __syncthreads();
  out[threadIdx.x] = values[threadIdx.x];
}

TEST_P(HostExecution, AccessesOutOfBoundsAreCaught) {
  Buffer<unsigned> out;
  out.resize(64);
  EXPECT_EQ(failure_of(PENUMBRA_KERNEL(reach_out), 1, 32, out.span(), 63u), "");
  EXPECT_THAT(failure_of(PENUMBRA_KERNEL(reach_out), 1, 32, out.span(), 64u), HasSubstr("element 64 of a span of 64"));
  EXPECT_THAT(failure_of(PENUMBRA_KERNEL(reach_out), 1, 32, out.span(), ~0u), HasSubstr("span of 64"));
  EXPECT_THAT(failure_of(PENUMBRA_KERNEL(reach_out_of_shared), 1, 32, 64u), HasSubstr("shared array of 64"));
}

TEST_P(HostExecution, UnwrittenSharedMemoryIsCaught) {
  Buffer<unsigned> out;
  out.resize(64);
  const std::string message = failure_of(PENUMBRA_KERNEL(read_unwritten), 2, 64, out.span());
  EXPECT_THAT(message, HasSubstr("thread 63: reads shared element 63, which nobody has written"));
}

// --- launches, memory, counts ----------------------------------------------------------------------------------------

TEST(HostRuntime, NoBlocksLaunchNothingAndTooManyThreadsAreRefused) {
  EXPECT_EQ(failure_of(PENUMBRA_KERNEL(reach_out), 0, 32, Span<unsigned>(), 0u), "");
  EXPECT_THAT(failure_of(PENUMBRA_KERNEL(reach_out), 1, 1025, Span<unsigned>(), 0u), HasSubstr("must be 1 to 1024"));
}

TEST(HostRuntime, MemoryIsLimitedAndHoldsNoNumbersAtFirst) {
  set_memory_limit(std::size_t(3) << 20);
  Buffer<float> buffer;
  buffer.resize(1000);
  std::vector<float> values(1000);
  buffer.download(Stream(), values.data());
  EXPECT_TRUE(std::isnan(values[0]));
  try {
    buffer.resize(std::size_t(1) << 20);
    ADD_FAILURE() << "4 MiB fit into 3";
  } catch (const DeviceError& e) {
    EXPECT_STREQ(e.what(), "out of device memory: 4 MiB wanted, 3 of 3 MiB are free");
  }
  EXPECT_EQ(buffer.size(), 0u);
  set_memory_limit(~std::size_t(0));
  buffer.resize(std::size_t(1) << 20);
  EXPECT_EQ(buffer.bytes(), std::size_t(4) << 20);
}

__global__ void double_values(Span<float> values) {
  const std::size_t i = global_thread();
  if (i < values.size) values[i] = 2.0f * values[i];
  tally(1);
}

TEST(HostRuntime, GraphsReplayUntilTheyForget) {
  const Stream stream;
  Buffer<float> values;
  values.upload(stream, std::vector<float>{1.0f});
  Graph graph;
  int captured = 0;
  const auto run = [&] {
    graph.run(stream, [&] {
      ++captured;
      launch(stream, PENUMBRA_KERNEL(double_values), 1, 32, values.span());
    });
  };
  run(), run(), graph.forget(), run();
  EXPECT_EQ(captured, 2);
  float value = 0.0f;
  values.download(stream, &value);
  EXPECT_EQ(value, 8.0f);
}

TEST(HostRuntime, LaunchesAreCounted) {
  const Stream stream;
  Buffer<float> values;
  values.upload(stream, std::vector<float>(100, 1.0f));
  count_launches(true);
  launch(stream, PENUMBRA_KERNEL(double_values), 4, 32, values.span());
  launch(stream, PENUMBRA_KERNEL(double_values), 4, 32, values.span());
  count_launches(false);
  const Counts counts = cuda_on_host::counts().at("double_values");
  EXPECT_EQ(counts.launches, 2u);
  EXPECT_EQ(counts.threads, 256u);
  EXPECT_EQ(counts.operations, 256.0);
  EXPECT_EQ(counts.bytes, 2u * 2u * 400u) << "each element is read and written";
  EXPECT_LE(counts.unique_bytes, 2u * (400u + 64u));
  EXPECT_GE(counts.unique_bytes, 2u * 400u);
}

}  // namespace
}  // namespace penumbra::cuda_on_host
