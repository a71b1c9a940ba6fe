#include "techniques/pcss/traversal.h"

namespace penumbra::pcss {

LeafSamples::LeafSamples(const SampleImage& image, const ShadowMap& map) : stride_(map.stride()) {
  for (int level = 0; level <= largest_level(map.resolution()); ++level)
    for (int variant = 0; variant < SampleImage::variants; ++variant) {
      const int edge = 1 << level, count = SampleImage::count(edge), first = SampleImage::first(edge);
      for (int k = 0; k < 16; ++k) {
        const vec2 at = image.position[variant][first + k % count] * float(edge);
        offset_.push_back(int(at.y) * stride_ + int(at.x));
      }
    }
}

}  // namespace penumbra::pcss
