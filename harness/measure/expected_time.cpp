#include "harness/measure/expected_time.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <thread>

namespace penumbra {
namespace {

/// Seconds of this machine for seconds of one core: fits and references use all.
double on_all_cores(double core_seconds) {
  return core_seconds / std::max(1u, std::thread::hardware_concurrency());
}

/// Milliseconds a frame where nothing like it has been measured.
double guessed_frame_ms(const RowIdentity& row) {
  const double us_per_receiver = row.backend == "scalar" ? 3.0 : row.backend == "simd" ? 0.8 / row.threads : 0.05;
  return 1e-3 * us_per_receiver * double(row.receivers);
}

struct Cost {
  double prepare_ms = 0.0, frame_ms = 0.0;
  bool measured = false;
};

Cost cost_of(const RowIdentity& row, const std::vector<Row>& earlier) {
  const Row* like = nullptr;
  for (const Row& old : earlier) {
    if (!old.ok() || old.timing.frame_ms.empty()) continue;
    if (old.id.name() == row.name()) return {old.timing.prepare_ms, old.timing.median_frame_ms(), true};
    if (!like && old.id.variant() == row.variant() && old.id.receivers > 0) like = &old;
  }
  if (!like) return {0.0, guessed_frame_ms(row), false};
  const double scale = double(row.receivers) / double(like->id.receivers);
  return {like->timing.prepare_ms * scale, like->timing.median_frame_ms() * scale, true};
}

}  // namespace

double expected_fit(std::size_t spheres, const std::string& objective) {
  const double each = objective == to_string(Objective::shadow)  ? 0.9
                      : objective == to_string(Objective::cover) ? 0.25
                                                                 : 0.02;  // core seconds
  return on_all_cores(1.0 + each * double(spheres));
}

double expected_reference(Rung rung, bool environment, int receivers, double noise) {
  const double n = receivers;
  if (rung == Rung::truth) {  // the rays it takes: of stratified rounds under environments, of ever more under lamps
    const double finer = 0.002 / noise;
    return on_all_cores(environment ? 1.3e-4 * n * std::pow(finer, 4.0 / 3.0) : 4e-4 * n * finer * finer);
  }
  return on_all_cores((rung == Rung::spheres ? 3e-4 : rung == Rung::cube ? 6e-5 : 5e-6) * n);
}

ExpectedRow expected_row(const RowIdentity& row, int repetitions, int frames, const std::vector<Row>& earlier) {
  const Cost cost = cost_of(row, earlier);
  constexpr double shortest_repetition_ms = 30.0;
  const double checked = cost.prepare_ms + (2.0 + frames) * cost.frame_ms;
  const double scored = 100.0 + 5e-3 * double(row.receivers);  // twin, metrics, pictures
  const double timed = repetitions * std::max(shortest_repetition_ms, cost.frame_ms);
  return {1e-3 * (checked + scored + timed), cost.measured};
}

std::string about(double seconds) {
  if (seconds < 1.0) return "less than a second";
  if (seconds < 10.0) return fmt::format("about {:.0f} s", seconds);
  if (seconds < 95.0) return fmt::format("about {:.0f} s", 10.0 * std::round(seconds / 10.0));
  if (seconds < 5700.0) return fmt::format("about {:.0f} min", seconds / 60.0);
  return fmt::format("about {:.0f} h", seconds / 3600.0);
}

}  // namespace penumbra
