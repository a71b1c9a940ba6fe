#include <benchmark/benchmark.h>
#include <tbb/task_arena.h>

#include "scenes/shapes.h"
#include "techniques/sh_lighting/transfer.h"

namespace penumbra::sh_lighting {
namespace {

/// The size of the 2015 article on SH lighting: 5,148 vertices x 10,000 directions, order 4. `packets`: 0 a plain loop
/// of rays, 1 packets.
void transfer_precomputation(benchmark::State& state) {
  const Mesh mesh = make_torus_knot(2, 3, 198, 26);
  const Receivers receivers = make_receivers({MeshVertices{}, vec3(1.0f)}, mesh);
  const RayScene rays(mesh);
  const DirectionSet set(4, 10000, 1);
  Request request;
  request.packets = state.range(0) == 1;
  tbb::task_arena arena(int(state.range(1)));
  for (auto _ : state)
    arena.execute([&] { benchmark::DoNotOptimize(compute_transfer(request, set, rays, mesh, receivers)); });
  state.counters["vertices"] = double(receivers.size());
  state.counters["ns_per_direction"] = benchmark::Counter(double(state.iterations()) * receivers.size() * 10000.0,
                                                          benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}
BENCHMARK(transfer_precomputation)
    ->ArgNames({"packets", "threads"})
    ->Args({0, 1})
    ->Args({1, 1})
    ->Args({1, 2})
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();

}  // namespace
}  // namespace penumbra::sh_lighting
