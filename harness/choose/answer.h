// What `penumbra choose` found.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "harness/choose/bound.h"
#include "harness/results/row.h"

namespace penumbra {

/// One source of an option's error: relative RMSE between the images before and after it.
struct ErrorPart {
  std::string name;
  double rel_rmse = 0.0;
};

/// The best configuration of one technique.
struct Option {
  Row row;            ///< measured like any other
  std::string label;  ///< technique, spheres and knobs
  bool within = false;
  double moving_ms = -1.0;       ///< of a frame in which the mesh has moved; -1: not asked for
  std::vector<ErrorPart> parts;  ///< largest first
};

/// Techniques that cannot answer, and why.
struct Impossible {
  std::string reason;
  std::vector<std::string> techniques;
};

struct Answer {
  Bound bound;
  std::string scene, scene_file, folder;
  bool moving = false;  ///< does the mesh move in what was timed?
  std::size_t receivers = 0;
  int threads = 1;
  std::optional<double> rel_noise;  ///< of the truth
  std::vector<Option> options;      ///< those within the bound first, the best first
  std::vector<Impossible> impossible;
  std::vector<std::string> left_out;  ///< what was not tried for want of time
  std::optional<Option> searched;     ///< beside an exhaustive grid: what the search alone would have answered
  std::optional<int> scene_spheres;   ///< that the scene file asks for
  bool busy = false;                  ///< had the machine more to do than it has cores when the search began?
  double truth_noise = 0.0;           ///< that the truth was asked for (`penumbra score --noise`)
  int looks = 0;
  double seconds = 0.0;

  /// Nothing if no option is within the bound.
  const Option* best() const { return !options.empty() && options.front().within ? &options.front() : nullptr; }
};

}  // namespace penumbra
