// bench_masks: the mask of a window as the ring loop grows it against words of bits that hold a row each, over all
// pixels near a shadow's edge of an image of 512 x 512. Both are compared first.
//
//   bench_masks --benchmark_repetitions=9 --benchmark_enable_random_interleaving=true
#include <benchmark/benchmark.h>
#include <tbb/task_arena.h>

#include <limits>
#include <map>
#include <memory>
#include <random>

#include "techniques/visibility_filter/surface_bits.h"

namespace {

using namespace penumbra;
using namespace penumbra::visibility_filter;

constexpr float epsilon = 0.05f;

/// A floor that recedes, sixty plates above it at random places, and their shadows beside them.
PixelMap plates(int edge) {
  PixelMap map;
  map.resize(edge, edge);
  for (int y = 0; y < edge; ++y)
    for (int x = 0; x < edge; ++x) {
      map.depth[map.index(x, y)] = 5.0f + 0.004f * float(x) + 0.002f * float(y);
      map.open[map.index(x, y)] = 1;
    }
  std::mt19937 random(1);
  for (int plate = 0; plate < 60; ++plate) {
    const int wide = 10 + int(random() % 60), high = 10 + int(random() % 60);
    const int left = int(random() % unsigned(edge - wide - 20)), top = int(random() % unsigned(edge - high - 20));
    for (int y = top; y < top + high; ++y)
      for (int x = left; x < left + wide; ++x) {
        map.depth[map.index(x, y)] -= 0.5f;
        map.open[map.index(x + 20, y + 20)] = 0;
      }
  }
  for (std::size_t i = 0; i < map.caster.size(); ++i)
    map.caster[i] = map.open[i] != 0 ? std::numeric_limits<float>::infinity() : 1.0f;
  return map;
}

/// The image, and those of its pixels whose windows hold both light and shadow.
struct Case {
  PixelMap map = plates(512);
  SurfaceBits bits;
  std::vector<std::pair<int, int>> pixels;
  bool equal;  ///< the masks, everywhere

  explicit Case(int r) {
    bits.set(map, epsilon, r);
    pixels.reserve(map.open.size());
    for (int y = 0; y < map.height; ++y)
      for (int x = 0; x < map.width; ++x)
        if (bits.is_mixed(x, y)) pixels.emplace_back(x, y);
    equal = compare(r);
  }

  Counted by_rings(int x, int y, int r, std::vector<std::uint8_t>& same) const {
    find_surface(map, x, y, r, epsilon, same);
    return count_surface(map, x, y, r, same);
  }

 private:
  bool compare(int r) const {
    std::vector<std::uint8_t> same;
    std::size_t cut = 0;
    for (const auto& [x, y] : pixels) {
      const Counted rings = by_rings(x, y, r, same);
      if (bits.count(x, y, r) != rings) return false;
      cut += rings.all < (2 * r + 1) * (2 * r + 1);
    }
    return cut > pixels.size() / 10;  // else there was nothing to mask
  }
};

int radius_of(const benchmark::State& state) {
  return (int(state.range(0)) - 1) / 2;
}

const Case& case_of(const benchmark::State& state) {
  static std::map<int, std::unique_ptr<Case>> cases;
  std::unique_ptr<Case>& c = cases[radius_of(state)];
  if (!c) c = std::make_unique<Case>(radius_of(state));
  return *c;
}

/// ns a pixel.
template <class Count>
void count_all(benchmark::State& state, const Count& count) {
  const Case& c = case_of(state);
  if (!c.equal) return state.SkipWithError("the masks differ");
  int sum = 0;
  for (auto _ : state)
    for (const auto& [x, y] : c.pixels) sum += count(c, x, y, radius_of(state)).open;
  benchmark::DoNotOptimize(sum);
  state.counters["ns_per_pixel"] = benchmark::Counter(
      double(c.pixels.size()) * 1e-9, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

void rings(benchmark::State& state) {
  std::vector<std::uint8_t> same;
  count_all(state, [&](const Case& c, int x, int y, int r) { return c.by_rings(x, y, r, same); });
}
void bits(benchmark::State& state) {
  count_all(state, [](const Case& c, int x, int y, int r) { return c.bits.count(x, y, r); });
}

/// Making the bits of the image, once a frame; ns a pixel of the image, on one thread.
void make_bits(benchmark::State& state) {
  const Case& c = case_of(state);
  SurfaceBits fresh;
  tbb::task_arena one(1);
  for (auto _ : state) one.execute([&] { fresh.set(c.map, epsilon, radius_of(state)); });
  state.counters["ns_per_pixel"] = benchmark::Counter(
      double(c.map.open.size()) * 1e-9, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

BENCHMARK(rings)->ArgName("width")->Arg(8)->Arg(20)->Arg(40)->Arg(63)->Unit(benchmark::kMillisecond);
BENCHMARK(bits)->ArgName("width")->Arg(8)->Arg(20)->Arg(40)->Arg(63)->Unit(benchmark::kMillisecond);
BENCHMARK(make_bits)->ArgName("width")->Arg(8)->Arg(20)->Arg(40)->Arg(63)->Unit(benchmark::kMillisecond);

}  // namespace

BENCHMARK_MAIN();
