#include "harness/results/derived.h"

#include <algorithm>

namespace penumbra {

bool faster(const Row& a, const Row& b) {
  const double noise = a.timing.frame_spread_ms() + b.timing.frame_spread_ms();
  return a.timing.median_frame_ms() + noise < b.timing.median_frame_ms();
}

bool nearer(const Row& a, const Row& b) {
  const auto ea = a.score.truth_error(), eb = b.score.truth_error();
  if (!ea || !eb) return false;
  const double floor = a.score.errors.at("truth").floor();
  return std::max(*ea, floor) < std::max(*eb, floor);
}

const Row* best_within(double limit, const std::vector<const Row*>& rows) {
  std::vector<const Row*> within;
  for (const Row* row : rows)
    if (row->score.truth_error() && row->timing.timed() &&
        (*row->score.truth_error() <= limit || row->score.errors.at("truth").tie()))
      within.push_back(row);
  const auto fastest = std::min_element(within.begin(), within.end(), [](const Row* a, const Row* b) {
    return a->timing.median_frame_ms() < b->timing.median_frame_ms();
  });
  if (fastest == within.end()) return nullptr;
  const Row* best = *fastest;
  for (const Row* row : within)
    if (!faster(**fastest, *row) && nearer(*row, *best)) best = row;
  return best;
}

std::vector<bool> pareto_optimal(const std::vector<const Row*>& rows) {
  std::vector<bool> optimal(rows.size());
  const auto counts = [](const Row& row) { return row.ok() && row.timing.timed() && row.score.truth_error(); };
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const Row& a = *rows[i];
    optimal[i] = counts(a) && std::none_of(rows.begin(), rows.end(), [&](const Row* b) {
                   if (b == &a || !counts(*b)) return false;
                   return (faster(*b, a) && !nearer(a, *b)) || (nearer(*b, a) && !faster(a, *b));
                 });
  }
  return optimal;
}

}  // namespace penumbra
