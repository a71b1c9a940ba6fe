// How times grow with one quantity while all others are held: spheres, threads, receivers, or a numeric parameter.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "harness/results/log_log.h"
#include "harness/results/row.h"

namespace penumbra {

/// Rows that are alike but for one quantity, by that quantity.
struct ScalingCurve {
  std::string axis;              ///< "spheres", "threads", "receivers", or a parameter's name
  std::vector<const Row*> rows;  ///< at least one, in the order of `points`
  std::vector<CurvePoint>
      points;  ///< x: the quantity; y: median of the frame in ms; noise: half the interquartile range
};

/// Where a row stands on an axis; empty if it has no such quantity, it is not positive, or the row does not read its
/// spheres.
std::optional<double> position_on(const std::string& axis, const Row& row);

/// The curves through rows of one scene that are ok and timed, over spheres, threads and each numeric parameter; each
/// has at least two different x.
std::vector<ScalingCurve> scaling_curves(const std::vector<const Row*>& rows);

/// The curves over receivers, through rows of scenes that are alike but for these. What a scene consists of does not
/// stand in a row, so scenes count as alike if their names differ in digits alone ("city-64", "city-256").
std::vector<ScalingCurve> receiver_curves(const std::vector<const Row*>& rows);

/// The name of a scene with '#' for each of its numbers.
std::string scene_stem(const std::string& scene);

/// Two techniques over the same quantity.
struct BreakEven {
  const ScalingCurve* first = nullptr;
  const ScalingCurve* second = nullptr;  ///< null: `level` stands in its place
  const Row* level = nullptr;  ///< a row that does not read spheres, and so takes as long for any number of them
  OrReason<Crossing> crossing;
};

/// Of every two curves over the same axis (threads and receivers excepted) that are of different techniques on the same
/// backend and as many threads, with the same values of all other parameters that both have; over spheres, also of
/// curves and rows that do not read them, where they cross.
std::vector<BreakEven> break_evens(const std::vector<ScalingCurve>& curves, const std::vector<const Row*>& rows);

}  // namespace penumbra
