// Finds the place on a line where a bound is met, in few looks.
#pragma once

#include <functional>
#include <limits>
#include <optional>

#include "harness/choose/bound.h"
#include "harness/choose/space.h"

namespace penumbra {

/// What one look at a configuration tells: shaded once.
struct Look {
  double ms = 0.0;              ///< of a frame, roughly
  std::optional<double> error;  ///< relative RMSE against truth; absent if that is black
  bool tie = false;             ///< is the error no more than the noise of the truth?

  bool within(const Bound& bound) const;
};

/// Looks at a configuration of a line; absent if it cannot be shaded.
using LookAt = std::function<std::optional<Look>(int value)>;

/// What takes longer is not worth pursuing, so that a slower line is given up early.
struct Worth {
  double beyond_ms = std::numeric_limits<double>::infinity();  ///< while the bound is not met
  double within_ms = std::numeric_limits<double>::infinity();  ///< once it is
};

struct Found {
  int value = 0;
  Look look;
};

/// The best of a line: under a bound of error the least value within it, under one of time the greatest. Brackets the
/// bound from the middle of the line outward by factors of 4, then halves the bracket until its ends are 8 % (or 1)
/// apart, or the knob hardly moves the time. If nothing is within: what comes nearest. Absent if nothing can be shaded.
std::optional<Found> best_on(const Line& line, const Bound& bound, const LookAt& look_at, const Worth& worth = {});

}  // namespace penumbra
