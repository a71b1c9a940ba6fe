// Variational covering of a solid by spheres (Wang et al. 2006, as Zhao & Che 2011 describe it in section 3.2).
#pragma once

#include "scenes/fit/fit.h"
#include "scenes/fit/fit_points.h"

namespace penumbra {

/// Balls that hold the whole solid, with a small sum of outside volumes. At most request.spheres of them.
SphereSet cover_solid(const Mesh& solid, const SolidRows& rows, FitPoints points, const FitRequest& request,
                      const FitProgress& progress);

/// Grows balls until they hold every point of the solid for certain: cells that one ball does not hold are divided down
/// to 1/16384 of the solid's box; what is left there and touches the solid goes to the ball that it makes grow least.
void make_covering(const Mesh& solid, SphereSet& set);

/// Points of the solid in those cells of 1/1024 of its box that touch it and are not within a single ball.
std::vector<vec3> loose_points(const Mesh& solid, const SphereSet& set);

}  // namespace penumbra
