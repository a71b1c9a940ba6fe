// bench_fit: how long a sphere fit takes and what it is worth; k-means and grid beside it. Volumes in percent of the
// solid's: `outside` sums over spheres, `excess` is that of their union, `uncovered` what no sphere holds. A fit of one
// seed is one sample: counters are medians over seeds 1 to 5, with the least and the most of them beside.
#include <benchmark/benchmark.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <vector>

#include "scenes/assets.h"
#include "scenes/carry.h"
#include "scenes/error.h"
#include "scenes/fit/fit.h"

namespace {

using namespace penumbra;

/// Median, least and most over seeds, as three counters.
void count(benchmark::State& state, const std::string& name, std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const std::size_t half = values.size() / 2;
  state.counters[name] = values.size() % 2 ? values[half] : 0.5 * (values[half - 1] + values[half]);
  state.counters[name + "_min"] = values.front();
  state.counters[name + "_max"] = values.back();
}

/// One iteration a seed, from 1 on.
void fit(benchmark::State& state, const std::string& name, FitRequest request) {
  try {
    const Mesh mesh = mesh_by_name(name);
    std::vector<double> outside, excess, uncovered, spheres;
    request.seed = 0;
    for (auto _ : state) {
      ++request.seed;
      const SphereSet set = fit_spheres(mesh, request, name);
      state.PauseTiming();
      const FitQuality quality = assess_fit(mesh, set, name);
      outside.push_back(100.0 * quality.outside / quality.volume);
      excess.push_back(100.0 * quality.excess / quality.volume);
      uncovered.push_back(100.0 * quality.uncovered / quality.volume);
      spheres.push_back(double(set.size()));
      state.ResumeTiming();
    }
    count(state, "outside_%", outside), count(state, "excess_%", excess), count(state, "uncovered_%", uncovered);
    count(state, "spheres", spheres);
  } catch (const Error& e) {
    state.SkipWithError(e.what());
  }
}

/// Moving the spheres of a deforming mesh: what a frame costs before any technique sees it.
void carry(benchmark::State& state, Carry how) {
  const Mesh rest = mesh_by_name("bunny");
  FitRequest request;
  request.spheres = int(state.range(0));
  SphereSet set = cached_fit(rest, request, "bunny");
  const SphereCarrier carrier(rest, set, how);
  Mesh moved = rest;
  for (vec3& p : moved.positions) p = {p.x + 0.3f * p.y, p.y, p.z - 0.2f * p.x};
  for (auto _ : state) {
    carrier.move(moved, set);
    benchmark::DoNotOptimize(set.spheres.data());
  }
}

void add(const std::string& mesh, int spheres, const std::string& label, const FitRequest& request) {
  const std::string name = "fit/" + mesh + "/spheres:" + std::to_string(spheres) + "/" + label;
  const bool random = request.objective == Objective::cover || request.objective == Objective::shadow;
  benchmark::RegisterBenchmark(name.c_str(), [mesh, request](benchmark::State& state) { fit(state, mesh, request); })
      ->Iterations(random ? 5 : 1)
      ->UseRealTime()
      ->Unit(benchmark::kSecond);
}

void add_fits(const std::string& mesh, const std::vector<int>& counts) {
  for (const int spheres : counts) {
    for (const Objective objective : {Objective::grid, Objective::k_means, Objective::cover, Objective::shadow})
      add(mesh, spheres, to_string(objective), {spheres, objective});
    add(mesh, spheres, "cover, flood", {spheres, Objective::cover, 1, Assignment::flood});
  }
}

}  // namespace

int main(int argc, char** argv) {
  spdlog::set_level(spdlog::level::warn);
  add_fits("torus", {16});
  for (const char* mesh : {"bunny", "horse", "torus-knot"}) add_fits(mesh, {8, 16, 32, 64, 128, 256});
  benchmark::RegisterBenchmark("carry/bunny/rigid", [](benchmark::State& state) { carry(state, Carry::rigid); })
      ->Arg(128)
      ->UseRealTime()
      ->Unit(benchmark::kMillisecond);
  benchmark::RegisterBenchmark("carry/bunny/affine", [](benchmark::State& state) { carry(state, Carry::affine); })
      ->Arg(128)
      ->UseRealTime()
      ->Unit(benchmark::kMillisecond);
  benchmark::Initialize(&argc, argv);
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}
