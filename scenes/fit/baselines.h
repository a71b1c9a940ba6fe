// Simple sphere sets that a fit must beat.
#pragma once

#include "scenes/fit/fit_points.h"

namespace penumbra {

/// k-means (Lloyd 1982, seeded by farthest points) of points inside; each ball reaches its farthest member.
SphereSet k_means_balls(const std::vector<vec3>& points, int count);

/// Balls around the cells of the finest cubic lattice of which the points occupy at most `count`.
SphereSet grid_balls(const Bounds& box, const std::vector<vec3>& points, int count);

}  // namespace penumbra
