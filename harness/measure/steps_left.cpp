#include "harness/measure/steps_left.h"

namespace penumbra {
namespace {

/// Seconds that a step takes as long as nothing is known: shipped scenes on two cores.
const std::map<std::string, double> guesses = {{"fit", 2.0},       {"reference", 2.0}, {"baseline", 1.0},
                                               {"sequence", 20.0}, {"check", 1.0},     {"time", 0.1}};

}  // namespace

std::string step_kind(Job::Kind kind) {
  switch (kind) {
    case Job::Kind::fit:
      return "fit";
    case Job::Kind::reference:
      return "reference";
    case Job::Kind::baseline:
      return "baseline";
    case Job::Kind::sequence:
      return "sequence";
    default:
      return "check";
  }
}

StepCounts steps_of(const PlannedScene& scene, int repetitions) {
  StepCounts counts;
  for (const Job& job : scene.jobs) ++counts[step_kind(job.kind)];
  counts["time"] = counts["check"] * repetitions;
  return counts;
}

StepCounts sum(StepCounts a, const StepCounts& b) {
  for (const auto& [kind, count] : b) a[kind] += count;
  return a;
}

void announce(const StepCounts& left, Progress& progress) {
  for (const auto& [kind, guess] : guesses) {
    const auto at = left.find(kind);
    progress.expect(kind, at == left.end() ? 0 : at->second, guess);
  }
}

}  // namespace penumbra
