// Rows of which time and error matter.
#pragma once

#include "harness/results/row.h"

namespace penumbra::test {

/// A row of scene "s" with one repetition; `noise`: of the truth, relative.
inline Row trade_row(const std::string& technique, double ms, std::optional<double> error, double noise = 0.0) {
  Row row;
  row.id.scene = "s", row.id.technique = technique, row.id.backend = "simd";
  row.id.receivers = 100, row.id.reads_spheres = false;
  if (ms > 0.0) row.timing.frame_ms = {ms};
  RungErrors& truth = row.score.errors["truth"];
  truth.report.all.rel_rmse = error;
  if (noise > 0.0) truth.rel_noise = noise;
  return row;
}

/// Rows as most functions take them.
inline std::vector<const Row*> pointers(const std::vector<Row>& rows) {
  std::vector<const Row*> all;
  all.reserve(rows.size());
  for (const Row& row : rows) all.push_back(&row);
  return all;
}

}  // namespace penumbra::test
