// Times of a technique's named sub-stages (Technique::stages).
#pragma once

#include <chrono>

#include "techniques/technique.h"

namespace penumbra {

class StageClock {
 public:
  using Clock = std::chrono::steady_clock;

  /// Stages that do not run until the next stages() took no time.
  void reset() {
    for (Stage& stage : stages_) stage.ms = 0.0;
  }

  void set(const std::string& name, double ms) {
    for (Stage& stage : stages_)
      if (stage.name == name) {
        stage.ms = ms;
        return;
      }
    stages_.push_back({name, ms});
  }

  template <class Work>
  void measure(const std::string& name, const Work& work) {
    const auto start = Clock::now();
    work();
    set(name, std::chrono::duration<double, std::milli>(Clock::now() - start).count());
  }

  const std::vector<Stage>& stages() const { return stages_; }

 private:
  std::vector<Stage> stages_;
};

}  // namespace penumbra
