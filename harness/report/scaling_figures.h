// Scaling and break-even points as JSON.
#pragma once

#include <nlohmann/json.hpp>
#include <vector>

#include "harness/results/row.h"

namespace penumbra {

/// Figures of rows of one scene that were measured.
struct ScalingFigures {
  nlohmann::json scaling, break_even;
};
ScalingFigures make_scaling_figures(const std::vector<const Row*>& rows);

/// Over the receivers of scenes that are alike but for these.
nlohmann::json make_receiver_figures(const std::vector<const Row*>& rows);

}  // namespace penumbra
