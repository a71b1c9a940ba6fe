// How many spheres are worth fitting next. A fit takes seconds to minutes, so what more or fewer spheres would bring is
// foretold from those that are there.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "harness/choose/bound.h"

namespace penumbra {

/// What a technique that shades with spheres reached with so many of them.
struct SphereLook {
  std::string technique;
  int spheres = 0;
  double ms = 0.0;        ///< of a frame
  double error = 0.0;     ///< against truth
  double geometry = 0.0;  ///< of the spheres alone
};

class SphereLadder {
 public:
  /// Counts that a search may ask for.
  static const std::vector<int>& counts();

  void add(const SphereLook& look);
  /// This count is done, or cannot be had.
  void close(int spheres) { closed_[spheres] = true; }

  /// The count to try next; absent if none promises anything. `best`: under a bound of error the least time within it
  /// so far, under one of time the least error. The first are 64 and 16. Fewer than 64 are tried where they promise a
  /// technique a better answer of its own, more, whose fits are dear, where they promise to beat `best`.
  std::optional<int> next(const Bound& bound, std::optional<double> best) const;

  /// Foretold for a technique: geometry's error falls as a power of the count (1/2 until two counts are known), the
  /// rest of the error stays, time grows with the count to the power 0.8.
  SphereLook foretell(const SphereLook& known, int spheres) const;

 private:
  double geometry_exponent() const;
  bool promises(const SphereLook& known, int spheres, const Bound& bound, std::optional<double> best) const;
  std::optional<double> own_best(const std::string& technique, const Bound& bound) const;

  std::vector<SphereLook> looks_;
  std::map<int, double> geometry_;  ///< by count
  std::map<int, bool> closed_;
};

}  // namespace penumbra
