// bench_haar: the binary transform through the 4 x 4 table against the ordinary one, and the triple products.
#include <benchmark/benchmark.h>

#include "techniques/bases/haar.h"
#include "techniques/bases/random.h"

namespace {

using namespace penumbra;

/// A disc of blocked texels on every face, as a sphere would leave: about a third of them.
BitCube blocked_cube(int n) {
  BitCube blocked(n);
  for (int t = 0; t < 6 * n * n; ++t) {
    const int row = t / n % n - n / 2, column = t % n - n / 3;
    if (row * row + column * column < n * n / 9) blocked.set(t);
  }
  return blocked;
}

std::vector<float> open_pixels(const BitCube& blocked, int face) {
  std::vector<float> pixels;
  pixels.reserve(std::size_t(blocked.n) * blocked.n);
  for (int k = 0; k < blocked.n * blocked.n; ++k)
    pixels.push_back(blocked.test(face * blocked.n * blocked.n + k) ? 0.0f : 1.0f);
  return pixels;
}

void binary_table(benchmark::State& state) {
  const BitCube blocked = blocked_cube(int(state.range(0)));
  haar::TwoLevel out;
  for (auto _ : state) {
    haar::transform_visibility(blocked, out);
    benchmark::DoNotOptimize(out.level1.data());
  }
}
BENCHMARK(binary_table)->Arg(16)->Arg(32)->Arg(64);

void dense(benchmark::State& state) {
  const BitCube blocked = blocked_cube(int(state.range(0)));
  std::vector<float> faces[6];
  for (int face = 0; face < 6; ++face) faces[face] = open_pixels(blocked, face);
  for (auto _ : state)
    for (const auto& face : faces) benchmark::DoNotOptimize(haar::transform(std::span<const float>(face)));
}
BENCHMARK(dense)->Arg(16)->Arg(32)->Arg(64);

void triple_product_linear(benchmark::State& state) {
  std::vector<float> p, l, v;
  for (auto* values : {&p, &l, &v}) values->reserve(1024);
  for (std::uint32_t k = 0; k < 1024; ++k) {
    const RandomTriple r = random_triple(1, k);
    p.push_back(r.x), l.push_back(r.y), v.push_back(r.z);
  }
  for (auto _ : state)
    benchmark::DoNotOptimize(
        haar::triple_product(std::span<const float>(p), std::span<const float>(l), std::span<const float>(v)));
}
BENCHMARK(triple_product_linear);

}  // namespace

BENCHMARK_MAIN();
