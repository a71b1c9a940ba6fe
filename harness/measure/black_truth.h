// Where no light arrives: what counts as black, and why it is so.
#pragma once

#include <string>

#include "scenes/scene.h"

namespace penumbra {

/// What the receivers would reflect if each faced all of the light and nothing stood in between: RMS over valid
/// receivers and channels, W m^-2 sr^-1. Environment: albedo / pi times the radiance over the whole sphere. Lamp:
/// albedo times radiance times the form factor, area / (pi distance^2) and at most 1. Scales with the light's unit.
double light_scale(const Light& light, const Receivers& receivers);

/// Images whose RMS is at most this are black. Directions in the horizon have cosines of 1e-17 instead of 0, so a truth
/// without light need not be exactly 0; below 1.2e-38 floats lose their digits.
double black_level(const Light& light, const Receivers& receivers);

/// Does any light reach any receiver if nothing stands in between? Looks at 64 samples of each until one says yes.
bool light_arrives(const Light& light, const Receivers& receivers);

/// "scene X: the truth is black: no receiver gets light; ..." with the likely reason. `arrives`: without an occluder
/// there would be light.
std::string black_note(const std::string& scene, const Light& light, const Receivers& receivers, bool arrives);

}  // namespace penumbra
