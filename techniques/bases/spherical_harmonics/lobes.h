// Functions that are symmetric about an axis, and what is done to every function band by band.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "scenes/math.h"

namespace penumbra::sh {

/// Zonal coefficients, one per band: those of m = 0 for the axis z.
using Zonal = std::vector<double>;

/// max(0, cos) about the axis: sqrt(pi)/2, sqrt(pi/3), 2 pi sqrt((2l+1)/(4 pi)) (-1)^(l/2-1) l! / ((l+2)(l-1) 2^l
/// ((l/2)!)^2) for even l >= 2, else 0 (Ramamoorthi & Hanrahan 2001).
Zonal cosine_lobe(int order);

/// Visibility behind a cap of angular radius theta, radians, that blocks: v_0 = sqrt(pi) (1 + x),
/// v_l = -sqrt(pi / (2l + 1)) (P_{l-1}(x) - P_{l+1}(x)), x = cos theta.
Zonal cap_visibility(int order, double theta);

/// The zonal function turned to a unit axis: sqrt(4 pi / (2l + 1)) z_l Y_lm(axis).
std::vector<double> rotate_zonal(const Zonal& zonal, dvec3 axis);

/// Factors per band that damp ringing: none 1; hann (1 + cos(pi l / n)) / 2; lanczos sinc(l / n);
/// laplacian 1 / (1 + lambda l^2 (l + 1)^2), lambda the squared-Laplacian penalty (Sloan 2008, section on windowing).
enum class Window { none, hann, lanczos, laplacian };
/// Throws Error listing the names.
Window parse_window(const std::string& name);
std::vector<double> window(Window kind, int order, double lambda = 0.005);

/// Multiplies every coefficient by its band's factor.
void apply_window(std::span<const double> factors, std::span<double> c);

}  // namespace penumbra::sh
