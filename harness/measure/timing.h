// Timing through Google Benchmark: manual time, random interleaving of all variants of a scene.
#pragma once

#include <functional>
#include <nlohmann/json.hpp>

#include "harness/results/row.h"
#include "techniques/technique.h"

namespace penumbra {

class Registry;

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

/// How many frames of about so many milliseconds make one repetition: at least `least_ms` of them, at most 1000.
long frames_per_repetition(double estimate_ms, double least_ms = 30.0);

/// Times frame after frame of a prepared technique. All that it is given outlives it.
class RepetitionTimer {
 public:
  /// `image`: where frames go; grows if it has to.
  RepetitionTimer(Technique& technique, Animation& animation, int threads, std::vector<vec3>& image);
  /// The motion's next frame. Returns its milliseconds; throws what the technique throws.
  double frame();
  /// Appends the means over all frames so far as one repetition.
  void add_to(Timing& timing) const;

 private:
  Technique& technique_;
  Animation& animation_;
  const std::unique_ptr<Clock> clock_;
  const int threads_;
  std::vector<vec3>& image_;
  double update_ = 0.0, shade_ = 0.0, cpu_ = 0.0;  ///< sums, ms
  long frames_ = 0;
  std::vector<Stage> stages_;
};

/// What is to be told while items are timed.
struct TimingEvents {
  std::function<void()> repetition;                ///< one begins
  std::function<void(const TimedItem&)> finished;  ///< an item has all its samples, or has failed
};

/// Fills in the samples. Stops early when interrupted: some items then have fewer than asked for.
void time_items(std::vector<TimedItem>& items, int repetitions, const TimingEvents& events);

/// Google Benchmark's context plus ours: CPU, caches, instruction sets, compiler, flags, commit, program, load.
nlohmann::json machine_context(const Registry& registry);

}  // namespace penumbra
