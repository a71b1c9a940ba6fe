#include "harness/measure/timing.h"

#include <benchmark/benchmark.h>
#include <tbb/task_arena.h>

#include <ctime>

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

/// Of all threads of this process.
double process_cpu_ms() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return 1e3 * double(now.tv_sec) + 1e-6 * double(now.tv_nsec);
}

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
  RepetitionTimer timer(*item.technique, animation, item.threads, image);
  int frames = 0;
  for (auto _ : state) {
    if (interrupted() || !item.failure.empty()) {
      state.SkipWithError("stopped");
      break;
    }
    try {
      state.SetIterationTime(1e-3 * timer.frame());
      ++frames;
    } catch (const std::exception& e) {
      item.failure = e.what();
      state.SkipWithError(e.what());
      break;
    }
  }
  if (frames == item.timing.iterations) timer.add_to(item.timing);
}

}  // namespace

long frames_per_repetition(double estimate_ms, double least_ms) {
  return std::clamp(long(std::ceil(least_ms / std::max(estimate_ms, 1e-3))), 1L, 1000L);
}

RepetitionTimer::RepetitionTimer(Technique& technique, Animation& animation, int threads, std::vector<vec3>& image)
    : technique_(technique), animation_(animation), clock_(technique.make_clock()), threads_(threads), image_(image) {
  image_.resize(std::max(image_.size(), std::size_t(animation.scene().receivers.size())));
}

double RepetitionTimer::frame() {
  const Receivers& receivers = animation_.scene().receivers;
  const Frame frame = animation_.frame(int(frames_) % animation_.frames());
  double ms[2];
  const double cpu_before = process_cpu_ms();
  tbb::task_arena(threads_).execute([&] {
    clock_->start();
    technique_.update(frame);
    ms[0] = clock_->lap();
    technique_.shade({image_.data(), receivers.width, receivers.height});
    ms[1] = clock_->lap();
  });
  cpu_ += process_cpu_ms() - cpu_before;
  update_ += ms[0], shade_ += ms[1], ++frames_;
  add_stages(technique_.stages(), stages_);
  return ms[0] + ms[1];
}

void RepetitionTimer::add_to(Timing& timing) const {
  const double share = 1.0 / double(frames_);
  timing.update_ms.push_back(update_ * share);
  timing.shade_ms.push_back(shade_ * share);
  timing.frame_ms.push_back((update_ + shade_) * share);
  timing.cpu_ms.push_back(cpu_ * share);
  add_samples(stages_, share, timing.stages);
}

void time_items(std::vector<TimedItem>& items, int repetitions, const TimingEvents& events) {
  if (items.empty()) return;
  initialise_once();
  benchmark::ClearRegisteredBenchmarks();
  std::vector<std::unique_ptr<Animation>> animations;  // each item sees its own sequence of frames
  std::vector<vec3> image;                             // one for all, as large as the largest
  for (TimedItem& item : items) {
    item.timing.iterations = frames_per_repetition(item.estimate_ms);
    Animation& animation = *animations.emplace_back(std::make_unique<Animation>(*item.scene));
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

nlohmann::json machine_context(const Registry& registry) {
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
  for (const auto& [key, value] : describe_machine(registry)) json[key] = value;
  const auto& load = json["load_avg"];
  json["busy"] = !load.empty() && load[0].get<double>() > json["num_cpus"].get<double>();
  return json;
}

}  // namespace penumbra
