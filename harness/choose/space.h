// The configurations of a technique that are worth a look, as its knobs span them.
#pragma once

#include "techniques/registry.h"

namespace penumbra {

/// Configurations that differ in one number alone: as it grows, so does the time, and the error falls.
struct Line {
  const Entry* entry = nullptr;
  Parameters fixed;         ///< given; others keep their defaults
  std::string knob;         ///< that number; empty: there is none, and the line is one configuration
  std::vector<int> values;  ///< of the knob, ascending: where to begin looking

  Parameters at(int value) const;  ///< resolved
  bool reads_spheres() const;
};

/// All combinations of an entry's knobs, the fine one (if any) as the lines' own. Those that the technique refuses are
/// left out.
std::vector<Line> lines_of(const Entry& entry);

/// Of every technique with knobs, the backends that can run here: without the scalar one where there is another, which
/// does the same faster.
std::vector<const Entry*> contenders(const Registry& registry);

}  // namespace penumbra
