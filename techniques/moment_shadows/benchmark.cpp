#include <benchmark/benchmark.h>

#include "techniques/bases/shadow_map/benchmark_map.h"
#include "techniques/moment_shadows/moments.h"

namespace penumbra::moment_shadows {
namespace {

void moments(benchmark::State& state) {
  const ShadowMap& map = map_of(int(state.range(0)));
  MomentTable table;
  for (auto _ : state) {
    table.build(map, map.view.farthest);
    benchmark::DoNotOptimize(table.sums(0));
  }
}
BENCHMARK(moments)->Arg(512)->Arg(1024)->Arg(2048)->Unit(benchmark::kMillisecond)->UseRealTime();

}  // namespace
}  // namespace penumbra::moment_shadows
