// About how long the pieces of a run take on this machine, before they are done. Rows are expected as they were
// measured before; everything else by rates that were measured once (two cores of an AMD EPYC) and are rough.
#pragma once

#include "harness/measure/plan.h"

namespace penumbra {

/// Seconds for a fit of so many spheres.
double expected_fit(std::size_t spheres, const std::string& objective);

/// Seconds for a rung of so many receivers. `noise`: of the truth, as a share of its RMS.
double expected_reference(Rung rung, bool environment, int receivers, double noise);

/// What a row is expected to cost.
struct ExpectedRow {
  double seconds = 0.0;
  bool measured = false;  ///< from a row of the same variant, not by a rate
};

/// A row of `earlier` with the same name tells; else one of the same variant on another scene, scaled to the number of
/// receivers; else the backend's rate. `frames`: those that are scored beside the one that is timed.
ExpectedRow expected_row(const RowIdentity& row, int repetitions, int frames, const std::vector<Row>& earlier);

/// "about 5 s", "about 40 s", "about 3 min": no more digits than are known.
std::string about(double seconds);

}  // namespace penumbra
