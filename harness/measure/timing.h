// Timing through Google Benchmark: manual time, random interleaving of all variants of a scene.
#pragma once

#include <functional>
#include <nlohmann/json.hpp>

#include "techniques/technique.h"

namespace penumbra {

/// A named sub-stage (Technique::stages): one mean per repetition.
struct StageSamples {
  std::string name;
  std::vector<double> ms;
};

/// One variant to be timed; it has been prepared and has shaded before.
struct TimedItem {
  std::string name;
  Technique* technique = nullptr;
  int threads = 1;
  double estimate_ms = 1.0;  ///< of a frame; sets how many frames make one repetition (at least 30 ms of them)

  long iterations = 0;                                ///< frames per repetition
  std::vector<double> update_ms, shade_ms, frame_ms;  ///< one mean per repetition
  std::vector<StageSamples> stages;
  std::string failure;  ///< empty, or what was thrown
};

/// Fills in the samples. `tick` is called before every repetition. Stops early when interrupted: items then have fewer
/// samples than asked for.
void time_items(std::vector<TimedItem>& items, const Scene& scene, int repetitions, const std::function<void()>& tick);

/// Google Benchmark's context plus ours: CPU, caches, instruction sets, compiler, flags, commit, load.
nlohmann::json machine_context();

double median(std::vector<double> values);

}  // namespace penumbra
