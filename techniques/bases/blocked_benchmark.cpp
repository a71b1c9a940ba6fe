// bench_blocked: what it costs to find the texels that spheres block, on one thread, by every way: the published table,
// the fine one, exact caps. The receivers of a plane and of a picture; 0 spheres is the horizon alone.
//
//   bench_blocked --benchmark_repetitions=9 --benchmark_enable_random_interleaving=true
#include <benchmark/benchmark.h>

#include "scenes/scene_file.h"
#include "techniques/bases/find_blocked.h"
#include "techniques/bases/visibility_source.h"

namespace {

using namespace penumbra;

const Scene& scene_of(bool picture) {
  static const Scene plane = load_scene("bunny-city"), camera = load_scene("bunny-city-camera");
  return picture ? camera : plane;
}

void find(benchmark::State& state, const char* visibility, bool picture) {
  const auto count = std::size_t(state.range(0));
  Scene scene = scene_of(picture);
  std::vector<std::size_t> which;  // some rows through the middle that lie on no mesh: those see spheres
  for (int i = 0; i < scene.receivers.size() && which.size() < 4096; i += picture ? 17 : 3)
    if (scene.receivers.valid(i) && !scene.receivers.on_occluder[i]) which.push_back(std::size_t(i));
  scene.receivers = subset(scene.receivers, which, int(which.size()), 1);
  scene.spheres.spheres.resize(std::min(count, scene.spheres.size()));
  if (count == 0) scene.spheres.spheres = {Sphere{vec3(0.0f), 0.0f}};
  Parameters parameters;
  parameters.set("visibility", std::string(visibility));
  VisibilitySource source(parameters.resolve(VisibilitySource::parameters(), "bench"), "bench");
  source.prepare(scene);
  std::vector<std::uint32_t> words(std::size_t(scene.receivers.size()) * 192);
  for (auto _ : state) {
    find_hidden(source.job(), 0, scene.receivers.size(), words.data());
    benchmark::DoNotOptimize(words.data());
  }
  const double spheres = double(scene.receivers.size()) * double(std::max<std::size_t>(1, count));
  const auto per = benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert;
  state.counters["ns_per_receiver"] = benchmark::Counter(double(scene.receivers.size()) * 1e-9, per);
  state.counters["ns_per_sphere"] = benchmark::Counter(spheres * 1e-9, per);
  state.counters["MiB"] = double(source.footprint().tables) / (1 << 20);
}

BENCHMARK_CAPTURE(find, plane_table, "table", false)->Arg(0)->Arg(16)->Arg(64)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(find, plane_fine, "fine", false)->Arg(16)->Arg(64)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(find, plane_raster, "raster", false)->Arg(16)->Arg(64)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(find, picture_table, "table", true)->Arg(0)->Arg(64)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(find, picture_fine, "fine", true)->Arg(64)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(find, picture_raster, "raster", true)->Arg(64)->Unit(benchmark::kMillisecond);

}  // namespace

BENCHMARK_MAIN();
