// Timing through Google Benchmark: manual time, random interleaving of all variants of a scene.
#pragma once

#include <functional>
#include <nlohmann/json.hpp>

#include "harness/results/row.h"
#include "techniques/technique.h"

namespace penumbra {

/// One variant to be timed; it has been prepared and has shaded before.
struct TimedItem {
  std::string name;
  Technique* technique = nullptr;
  const Scene* scene = nullptr;  ///< that it was prepared for
  int threads = 1;
  double estimate_ms = 1.0;  ///< of a frame; sets how many frames make one repetition (at least 30 ms of them)

  Timing timing;        ///< iterations and samples are filled in
  std::string failure;  ///< empty, or what was thrown
};

/// What is to be told while items are timed.
struct TimingEvents {
  std::function<void()> repetition;                ///< one begins
  std::function<void(const TimedItem&)> finished;  ///< an item has all its samples, or has failed
};

/// Fills in the samples. Stops early when interrupted: some items then have fewer than asked for.
void time_items(std::vector<TimedItem>& items, int repetitions, const TimingEvents& events);

/// Google Benchmark's context plus ours: CPU, caches, instruction sets, compiler, flags, commit, program, load.
nlohmann::json machine_context();

}  // namespace penumbra
