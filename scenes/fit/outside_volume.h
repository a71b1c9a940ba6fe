// How much of a ball lies outside a solid: the error that a sphere of a covering set makes (Wang et al. 2006).
#pragma once

#include "scenes/sphere_set.h"

namespace penumbra {

/// Volume of the sphere minus the solid, cubic metres; a sum over triangles in closed form, exact to rounding.
/// Zero-area triangles contribute nothing.
///
/// Seen from the centre o, a triangle ends the solid at distance t(w). What ball and solid share is
///   sum over triangles of sign(n . (v - o)) * integral over its solid angle of min(t, R)^3 / 3 dw.
/// The disc in which the ball meets the triangle's plane splits every edge; each piece is a triangle or a sector about
/// the foot of the perpendicular from o, and has elementary area and solid angle.
double outside_volume(const Mesh& solid, const Sphere& sphere);

/// Sum of the spheres' volumes outside the solid, cubic metres; what two share outside counts twice, as in the paper.
double outside_volume(const Mesh& solid, const SphereSet& set);

}  // namespace penumbra
