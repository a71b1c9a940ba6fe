// bench_rays: what it costs that rays start where rounding ends (scenes/ray_origins.h): placing the origins, once a
// scene, and tracing from them, against origins lifted by a share of the mesh on the way.
//
// And what a mesh that moves costs in a frame: its tree built anew, or refitted (RayScene::move).
//
//   bench_rays --benchmark_repetitions=9 --benchmark_enable_random_interleaving=true
#include <benchmark/benchmark.h>
#include <tbb/task_arena.h>

#include "scenes/ray_origins.h"
#include "scenes/scene_file.h"
#include "scenes/tree_decay.h"
#include "techniques/bases/ray_packets.h"

namespace {

using namespace penumbra;

constexpr int rays_per_receiver = 64;
constexpr const char* scenes[] = {"bunny-city", "bunny-city-camera"};

/// A shipped scene, and the light's samples of sixteen receivers at a time, shared by all of them.
struct Case {
  Scene scene;
  RayScene rays;
  std::vector<LightSample> samples;
  explicit Case(const char* name) : scene(load_scene(name)), rays(scene.mesh) {
    LightSampler::Scratch scratch;
    LightSampler(scene.light).draw(vec3(0.0f), {0, 1, 0}, rays_per_receiver, 1, scratch);
    samples = scratch.samples;
  }
};

const Case& case_of(const benchmark::State& state) {
  static const Case cases[] = {Case(scenes[0]), Case(scenes[1])};
  return cases[state.range(0)];
}

/// One thread, packets in the order of receivers; ns per ray.
template <class Origin>
void trace(benchmark::State& state, const Case& c, Origin origin) {
  const Receivers& r = c.scene.receivers;
  std::size_t hits = 0;
  for (auto _ : state) {
    auto queue = make_ray_queue<int>(c.rays, [&](int, bool hit) { hits += hit; });
    for (int first = 0; first < r.size(); first += RayPacket::size)
      for (const LightSample& s : c.samples)
        for (int i = first; i < std::min(r.size(), first + RayPacket::size); ++i)
          if (r.valid(i)) queue.push(i, origin(r, i), s.direction, s.reach());
    queue.flush();
  }
  const double rays = double(r.size()) * rays_per_receiver;
  state.SetLabel(scenes[state.range(0)]);
  state.counters["ns_per_ray"] =
      benchmark::Counter(rays * 1e-9, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
  state.counters["blocked"] = benchmark::Counter(double(hits) / rays, benchmark::Counter::kAvgIterations);
}

void lifted(benchmark::State& state) {
  const Case& c = case_of(state);
  const float lift = 1e-4f * glm::length(bounds(c.scene.mesh).extent());
  trace(state, c, [&](const Receivers& r, int i) { return r.position[i] + lift * r.normal[i]; });
}
BENCHMARK(lifted)->Arg(0)->Arg(1)->Unit(benchmark::kMillisecond);

void placed(benchmark::State& state) {
  trace(state, case_of(state), [](const Receivers& r, int i) { return r.ray_origin(i); });
}
BENCHMARK(placed)->Arg(0)->Arg(1)->Unit(benchmark::kMillisecond);

/// One thread; ns per ray of the 64 that a receiver asks for.
void placing(benchmark::State& state) {
  const Case& c = case_of(state);
  const Receivers& r = c.scene.receivers;
  for (auto _ : state) {
    const RayOrigins origins(c.scene.mesh, c.rays);
    vec3 sum(0.0f);
    for (int i = 0; i < r.size(); ++i)
      if (r.valid(i)) sum += origins.contact(r.position[i]).distance * r.normal[i];
    benchmark::DoNotOptimize(sum);
  }
  state.SetLabel(scenes[state.range(0)]);
  state.counters["ns_per_ray"] =
      benchmark::Counter(double(r.size()) * rays_per_receiver * 1e-9,
                         benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}
BENCHMARK(placing)->Arg(0)->Arg(1)->Unit(benchmark::kMillisecond);

/// One thread; a frame's tree, the mean over all frames of the motion.
void tree(benchmark::State& state) {
  static const Scene scenes_that_move[] = {load_scene("bunny-twisting"), load_scene("torus-knot-twisting")};
  const Scene& scene = scenes_that_move[state.range(0)];
  Animation animation(scene);
  std::vector<Mesh> frames;
  frames.reserve(animation.frames());
  for (int k = 0; k < animation.frames(); ++k) frames.push_back(animation.frame(k).mesh);
  RayScene rays;
  const TreeDecay decay(frames[0]);
  double growth = 0.0;
  for (const Mesh& mesh : frames) growth = std::max(growth, decay.growth(mesh));
  std::size_t k = 0;
  tbb::task_arena(1).execute([&] {
    for (auto _ : state) {
      const Mesh& mesh = frames[k++ % frames.size()];
      if (state.range(1)) rays.move(mesh);
      else rays.build(mesh);
    }
  });
  state.SetLabel(scene.name + (state.range(1) ? ", refitted" : ", rebuilt"));
  state.counters["growth"] = growth;
}
BENCHMARK(tree)->ArgsProduct({{0, 1}, {0, 1}})->Unit(benchmark::kMillisecond);

}  // namespace

BENCHMARK_MAIN();
