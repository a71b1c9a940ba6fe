#include "harness/measure/timing.h"

#include <benchmark/benchmark.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <sstream>

#include "harness/measure/interrupt.h"
#include "harness/measure/machine.h"

namespace penumbra {
namespace {

void initialise_once() {
  static const bool done = [] {
    static char program[] = "penumbra", interleave[] = "--benchmark_enable_random_interleaving=true";
    static char all[] = "--benchmark_filter=.", nowhere[] = "--benchmark_out=";  // whatever the environment says
    static char* arguments[] = {program, interleave, all, nowhere, nullptr};     // kept by the library
    int count = 4;
    benchmark::Initialize(&count, arguments);
    return true;
  }();
  (void)done;
}

/// Our rows take their samples from the benchmark functions.
class SilentReporter : public benchmark::BenchmarkReporter {
 public:
  bool ReportContext(const Context&) override { return true; }
  void ReportRuns(const std::vector<Run>&) override {}
};

/// Sums of stages by name, in the order of their first appearance.
void add_stages(const std::vector<Stage>& stages, std::vector<Stage>& sums) {
  for (const Stage& stage : stages) {
    const auto at = std::find_if(sums.begin(), sums.end(), [&](const Stage& s) { return s.name == stage.name; });
    if (at == sums.end()) sums.push_back(stage);
    else at->ms += stage.ms;
  }
}

void add_samples(const std::vector<Stage>& sums, double factor, std::vector<StageSamples>& samples) {
  for (const Stage& sum : sums) {
    auto at = std::find_if(samples.begin(), samples.end(), [&](const StageSamples& s) { return s.name == sum.name; });
    if (at == samples.end()) at = samples.insert(at, {sum.name, {}});
    at->ms.push_back(sum.ms * factor);
  }
}

void run_repetition(benchmark::State& state, TimedItem& item, Animation& animation, std::vector<vec3>& image) {
  Timing& timing = item.timing;
  const Scene& scene = animation.scene();
  double update = 0.0, shade = 0.0;
  std::vector<Stage> stages;
  int index = 0;
  const std::unique_ptr<Clock> clock = item.technique->make_clock();
  tbb::task_arena arena(item.threads);
  for (auto _ : state) {
    if (interrupted() || !item.failure.empty()) {
      state.SkipWithError("stopped");
      break;
    }
    const Frame frame = animation.frame(index++ % animation.frames());
    double ms[2];
    try {
      arena.execute([&] {
        clock->start();
        item.technique->update(frame);
        ms[0] = clock->lap();
        item.technique->shade({image.data(), scene.receivers.width, scene.receivers.height});
        ms[1] = clock->lap();
      });
    } catch (const std::exception& e) {
      item.failure = e.what();
      state.SkipWithError(e.what());
      break;
    }
    update += ms[0], shade += ms[1];
    add_stages(item.technique->stages(), stages);
    state.SetIterationTime(1e-3 * (ms[0] + ms[1]));
  }
  if (index != timing.iterations) return;
  const double share = 1.0 / double(index);
  timing.update_ms.push_back(update * share);
  timing.shade_ms.push_back(shade * share);
  timing.frame_ms.push_back((update + shade) * share);
  add_samples(stages, share, timing.stages);
}

}  // namespace

void time_items(std::vector<TimedItem>& items, int repetitions, const TimingEvents& events) {
  if (items.empty()) return;
  initialise_once();
  benchmark::ClearRegisteredBenchmarks();
  std::vector<std::unique_ptr<Animation>> animations;  // each item sees its own sequence of frames
  std::vector<vec3> image;                             // one for all, as large as the largest
  for (TimedItem& item : items) {
    item.timing.iterations = std::clamp(long(std::ceil(30.0 / std::max(item.estimate_ms, 1e-3))), 1L, 1000L);
    Animation& animation = *animations.emplace_back(std::make_unique<Animation>(*item.scene));
    image.resize(std::max(image.size(), std::size_t(item.scene->receivers.size())));
    const auto repetition = [&, repetitions](benchmark::State& state) {
      events.repetition();
      const bool over = !item.failure.empty();
      run_repetition(state, item, animation, image);
      if (!over && (!item.failure.empty() || int(item.timing.frame_ms.size()) == repetitions)) events.finished(item);
    };
    benchmark::RegisterBenchmark(item.name.c_str(), repetition)
        ->UseManualTime()
        ->Unit(benchmark::kMillisecond)
        ->Iterations(item.timing.iterations)
        ->Repetitions(repetitions);
  }
  SilentReporter reporter;
  benchmark::RunSpecifiedBenchmarks(&reporter);
  benchmark::ClearRegisteredBenchmarks();
}

nlohmann::json machine_context() {
  initialise_once();
  std::ostringstream out;
  benchmark::JSONReporter reporter;
  reporter.SetOutputStream(&out);
  reporter.SetErrorStream(&out);
  benchmark::BenchmarkReporter::Context context;
  reporter.ReportContext(context);
  reporter.Finalize();
  std::string text = out.str();  // "{ context: {...}, benchmarks: [" and, from Finalize, "]}"
  nlohmann::json json = nlohmann::json::parse(text)["context"];
  json.erase("host_name");
  json.erase("executable");
  json.erase("library_build_type");  // of Google Benchmark, not of what is measured
  for (const auto& [key, value] : describe_machine()) json[key] = value;
  const auto& load = json["load_avg"];
  json["busy"] = !load.empty() && load[0].get<double>() > json["num_cpus"].get<double>();
  return json;
}

}  // namespace penumbra
