// bench_pcss: building multi-scale maps (Zhu et al. 2019, Table 1), and the quadtree against every texel.
#include <benchmark/benchmark.h>
#include <tbb/task_arena.h>

#include <random>

#include "techniques/bases/shadow_map/benchmark_map.h"
#include "techniques/pcss/kernel.h"

namespace {

using namespace penumbra;
using namespace penumbra::pcss;

void build(benchmark::State& state, LevelLayout layout) {
  const ShadowMap& map = map_of(int(state.range(0)));
  MultiScaleMap levels;
  tbb::task_arena arena(state.range(1) != 0 ? tbb::task_arena::automatic : 1);
  for (auto _ : state) {
    arena.execute([&] { levels.build(map, layout, 99); });
    benchmark::DoNotOptimize(levels.means());
  }
  state.counters["MiB"] = double(levels.bytes()) / 1048576.0;
}
BENCHMARK_CAPTURE(build, full, LevelLayout::full)
    ->ArgNames({"map", "parallel"})
    ->ArgsProduct({{512, 1024, 2048, 4096}, {0, 1}})
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();
BENCHMARK_CAPTURE(build, reduced, LevelLayout::reduced)
    ->ArgNames({"map", "parallel"})
    ->ArgsProduct({{512, 1024, 2048, 4096}, {0, 1}})
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();

/// Squares of 64 texels all over the map, at the ground's depth.
struct Query {
  Square square;
  float depth;
};
std::vector<Query> queries(const ShadowMap& map) {
  std::mt19937 random(1);
  std::vector<Query> all;
  all.reserve(4096);
  const auto room = unsigned(map.resolution() - 63);
  for (int k = 0; k < 4096; ++k)
    all.push_back({{int(random() % room), int(random() % room), 6}, 0.95f * map.view.farthest});
  return all;
}

template <class Sum>
void each_query(benchmark::State& state, const Sum& sum) {
  const auto all = queries(map_of(1024));
  std::size_t k = 0;
  for (auto _ : state) benchmark::DoNotOptimize(sum(all[k++ % all.size()]));
}

Texels texels_of(const Square& s) {
  return {s.left, s.left + s.edge(), s.top, s.top + s.edge()};
}

void texels_scalar(benchmark::State& state) {
  each_query(state, [&](const Query& q) { return blockers_of_texels(map_of(1024), texels_of(q.square), q.depth); });
}
BENCHMARK(texels_scalar);

void texels_simd(benchmark::State& state) {
  each_query(state,
             [&](const Query& q) { return simd::blockers_of_texels(map_of(1024), texels_of(q.square), q.depth); });
}
BENCHMARK(texels_simd);

void quadtree(benchmark::State& state, bool vectorised) {
  const ShadowMap& map = map_of(1024);
  MultiScaleMap levels;
  levels.build(map, LevelLayout::reduced, 6);
  const LeafSamples samples(make_sample_image(), map);
  each_query(state, [&](const Query& q) {
    if (vectorised) return simd::blockers_of_square(map, levels, samples, q.square, 3, q.depth, Sum::sampled, true);
    Blockers found;
    traverse<true>(
        levels, q.square, 3, q.depth,
        [&](const Square& leaf, const DepthRange&) { return sampled_leaf(map, samples, leaf, q.depth); }, found);
    return found;
  });
}
BENCHMARK_CAPTURE(quadtree, scalar, false);
BENCHMARK_CAPTURE(quadtree, simd, true);

}  // namespace

BENCHMARK_MAIN();
