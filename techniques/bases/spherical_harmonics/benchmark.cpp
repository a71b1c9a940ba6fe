// bench_sh: what spherical harmonics techniques share, one function at a time; each technique adds its own.
#include <benchmark/benchmark.h>

#include <numeric>

#include "techniques/bases/random.h"
#include "techniques/bases/spherical_harmonics/basis.h"
#include "techniques/bases/spherical_harmonics/kernel.h"
#include "techniques/bases/spherical_harmonics/lobes.h"
#include "techniques/bases/spherical_harmonics/projection.h"
#include "techniques/bases/spherical_harmonics/rotation.h"
#include "techniques/bases/spherical_harmonics/straight_line.h"
#include "techniques/bases/spherical_harmonics/tensor.h"

namespace {

using namespace penumbra;  // NOLINT: a program of ours

constexpr int items = 128;  // of a batch: stays in the first-level cache

/// Numbers in [-1, 1), or below.
std::vector<float> numbers(std::size_t count, float scale = 1.0f) {
  std::vector<float> out;
  out.reserve(count);
  for (std::uint32_t k = 0; k < count; ++k) out.push_back(scale * (2.0f * random_triple(1, k).x - 1.0f));
  return out;
}

/// Time per item, printed as `per_item`.
void per_item(benchmark::State& state, double each) {
  state.counters["per_item"] =
      benchmark::Counter(double(state.iterations()) * each, benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}

void evaluate_one(benchmark::State& state) {
  sh::with_order<1, 10>(int(state.range(0)), [&](auto n) {
    const std::vector<float> w = numbers(3);
    float x = w[0], out[100];
    for (auto _ : state) {
      benchmark::DoNotOptimize(x);
      sh::evaluate<n>(x, w[1], w[2], out);
      benchmark::DoNotOptimize(out);
    }
  });
  per_item(state, 1);
}
BENCHMARK(evaluate_one)->DenseRange(2, 6)->Arg(10);

void evaluate_oracle(benchmark::State& state) {
  for (auto _ : state) benchmark::DoNotOptimize(sh::evaluate(int(state.range(0)), {0.48, 0.6, 0.64}));
  per_item(state, 1);
}
BENCHMARK(evaluate_oracle)->Arg(4);

void evaluate_in_batches(benchmark::State& state) {
  const std::vector<float> x = numbers(items), y = numbers(items), z = numbers(items);
  const float* const direction[3] = {x.data(), y.data(), z.data()};
  std::vector<float> out(std::size_t(items) * sh::coefficients(int(state.range(0))));
  for (auto _ : state) {
    sh::evaluate_batch(int(state.range(0)), direction, items, out.data());
    benchmark::DoNotOptimize(out.data());
  }
  per_item(state, items);
}
BENCHMARK(evaluate_in_batches)->DenseRange(2, 6)->Arg(10);

void product_one(benchmark::State& state) {
  const auto size = std::size_t(sh::coefficients(int(state.range(0))));
  const std::vector<float> f = numbers(size), g = numbers(size, 0.5f);
  std::vector<float> out(size);
  for (auto _ : state) {
    sh::product(int(state.range(0)), f.data(), g.data(), out.data());
    benchmark::DoNotOptimize(out.data());
    benchmark::ClobberMemory();
  }
  per_item(state, 1);
}
BENCHMARK(product_one)->DenseRange(2, 6);

void product_oracle(benchmark::State& state) {
  const sh::Tensor& tensor = sh::tensor(int(state.range(0)));
  const std::vector<float> random = numbers(std::size_t(sh::coefficients(int(state.range(0)))));
  const std::vector<double> f(random.begin(), random.end());
  for (auto _ : state) benchmark::DoNotOptimize(tensor.product(f, f));
  per_item(state, 1);
}
BENCHMARK(product_oracle)->Arg(4);

void product_in_batches(benchmark::State& state) {
  const auto size = std::size_t(sh::coefficients(int(state.range(0)))) * items;
  const std::vector<float> f = numbers(size), g = numbers(size, 0.5f);
  std::vector<float> out(size);
  for (auto _ : state) {
    sh::product_batch(int(state.range(0)), f.data(), g.data(), items, out.data());
    benchmark::DoNotOptimize(out.data());
  }
  per_item(state, items);
}
BENCHMARK(product_in_batches)->DenseRange(2, 6);

void square_in_batches(benchmark::State& state) {
  const auto size = std::size_t(sh::coefficients(int(state.range(0)))) * items;
  const std::vector<float> f = numbers(size, 0.5f);
  std::vector<float> out(size);
  for (auto _ : state) {
    sh::square_batch(int(state.range(0)), f.data(), items, out.data());
    benchmark::DoNotOptimize(out.data());
  }
  per_item(state, items);
}
BENCHMARK(square_in_batches)->DenseRange(4, 6);

void zonal_rotation(benchmark::State& state) {
  sh::with_order<1, 6>(int(state.range(0)), [&](auto n) {
    const std::vector<float> zonal = numbers(n);
    vec3 axis = glm::normalize(vec3(0.3f, 0.5f, 0.8f));
    float out[36];
    for (auto _ : state) {
      benchmark::DoNotOptimize(axis);
      sh::rotate_zonal<n>(zonal.data(), axis.x, axis.y, axis.z, out);
      benchmark::DoNotOptimize(out);
    }
  });
  per_item(state, 1);
}
BENCHMARK(zonal_rotation)->DenseRange(2, 6);

void full_rotation(benchmark::State& state) {
  const sh::Rotation rotation(int(state.range(0)), glm::dmat3({0, 0, 1}, {1, 0, 0}, {0, 1, 0}));
  std::vector<float> c = numbers(std::size_t(sh::coefficients(int(state.range(0))))), out(c.size());
  for (auto _ : state) {
    benchmark::DoNotOptimize(c.data());
    rotation(c.data(), out.data());
    benchmark::DoNotOptimize(out.data());
    benchmark::ClobberMemory();
  }
  per_item(state, 1);
}
BENCHMARK(full_rotation)->DenseRange(2, 6);

void full_rotation_in_batches(benchmark::State& state) {
  const sh::Rotation rotation(int(state.range(0)), glm::dmat3({0, 0, 1}, {1, 0, 0}, {0, 1, 0}));
  const std::vector<float> f = numbers(sh::batch_floats(int(state.range(0)), items));
  std::vector<float> out(f.size());
  for (auto _ : state) {
    sh::rotate_batch(rotation, f.data(), items, out.data());
    benchmark::DoNotOptimize(out.data());
    benchmark::ClobberMemory();
  }
  per_item(state, items);
}
BENCHMARK(full_rotation_in_batches)->DenseRange(2, 6);

void make_full_rotation(benchmark::State& state) {
  for (auto _ : state)
    benchmark::DoNotOptimize(sh::Rotation(int(state.range(0)), glm::dmat3({0, 0, 1}, {1, 0, 0}, {0, 1, 0})));
  per_item(state, 1);
}
BENCHMARK(make_full_rotation)->Arg(4)->Arg(6);

/// A latitude-longitude image of 1024 x 512.
void project_image(benchmark::State& state) {
  Environment e;
  e.width = 1024, e.height = 512;
  e.radiance.assign(std::size_t(e.width) * e.height, vec3(0.5f));
  for (auto _ : state) benchmark::DoNotOptimize(sh::project_texels(int(state.range(0)), e));
}
BENCHMARK(project_image)->Arg(4)->Arg(6)->Unit(benchmark::kMillisecond);

}  // namespace

BENCHMARK_MAIN();
