#include <benchmark/benchmark.h>

#include "techniques/bases/spherical_harmonics/basis.h"
#include "techniques/bases/spherical_harmonics/lobes.h"
#include "techniques/sh_exponentiation/exponential.h"

namespace penumbra::sh_exponentiation {
namespace {

/// The logarithm of one cap of 50 degrees.
void exponential_one(benchmark::State& state) {
  const int order = int(state.range(0));
  const LogTable table(order);
  const LinearFit fit = fit_to_caps(table);
  std::vector<float> f, g(std::size_t(sh::coefficients(order)));
  for (const double value : sh::rotate_zonal(cap_logarithm(order, 0.87), glm::normalize(dvec3(1, 2, 3))))
    f.push_back(float(value));
  for (auto _ : state) {
    optimal_linear(fit, f.data(), int(f.size()), f[0] * 0.28209479177387814f, g.data());
    benchmark::DoNotOptimize(g.data());
    benchmark::ClobberMemory();
  }
  state.counters["per_item"] =
      benchmark::Counter(double(state.iterations()), benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}
BENCHMARK(exponential_one)->DenseRange(4, 6);

}  // namespace
}  // namespace penumbra::sh_exponentiation
