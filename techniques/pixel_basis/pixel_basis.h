// Direct summation over the texels of a cube map: the ground truth of Zhao & Che 2011.
#pragma once

#include "techniques/bases/visibility_source.h"

namespace penumbra {

/// The paper's equation, a receiver and a texel at a time; other backends are built upon it.
class PixelBasis : public Technique {
 public:
  explicit PixelBasis(const Parameters& p) : visibility_(p, "pixel-basis") {}
  void prepare(const Scene& scene, const Light& light) override;
  void update(const Frame& frame) override;
  void shade(View<vec3> radiance) override;
  Footprint footprint() const override;

 protected:
  VisibilitySource visibility_;
  CubeLight light_;
  const Receivers* receivers_ = nullptr;
};

}  // namespace penumbra
