// bench_fit: how long a sphere fit takes and what it is worth; k-means and grid beside it. Volumes in percent of the
// solid's: `outside` sums over spheres, `excess` is that of their union, `uncovered` what no sphere holds.
#include <benchmark/benchmark.h>
#include <spdlog/spdlog.h>

#include "scenes/assets.h"
#include "scenes/carry.h"
#include "scenes/error.h"
#include "scenes/fit/fit.h"

namespace {

using namespace penumbra;

void fit(benchmark::State& state, const std::string& name, const FitRequest& request) {
  try {
    const Mesh mesh = mesh_by_name(name);
    SphereSet set;
    for (auto _ : state) set = fit_spheres(mesh, request, name);
    const FitQuality quality = assess_fit(mesh, set, name);
    state.counters["outside_%"] = 100.0 * quality.outside / quality.volume;
    state.counters["excess_%"] = 100.0 * quality.excess / quality.volume;
    state.counters["uncovered_%"] = 100.0 * quality.uncovered / quality.volume;
    state.counters["spheres"] = double(set.size());
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
  benchmark::RegisterBenchmark(name.c_str(), [mesh, request](benchmark::State& state) { fit(state, mesh, request); })
      ->Iterations(1)
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
