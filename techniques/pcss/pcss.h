// The shadow-map family for area lights: percentage-closer soft shadows and relatives.
#pragma once

namespace penumbra {

class Registry;

/// shadow-map, pcss, hqepcss, fast-pcss, pcss-rotated, moment-shadows; scalar and simd.
void register_pcss(Registry& registry);

}  // namespace penumbra
