// What the simd backends of all shadow-map techniques vectorise alike; a technique's own steps stand in its folder.
#pragma once

#include "techniques/bases/instruction_set.h"
#include "techniques/bases/shadow_map/area_shadow.h"
#include "techniques/bases/shadow_map/kernel.h"

namespace penumbra::shadow_map {

/// `Scalar` with vectors of receivers where it lights and projects them.
template <class Scalar>
class Simd : public Scalar {
 public:
  using Scalar::Scalar;
  std::string instruction_set() const override { return instruction_set_of_kernels(); }

 protected:
  void find_unshadowed(const LampOutline& lamp, int begin, int end, float* factor) const override {
    simd::find_unshadowed(lamp, *this->receivers_, begin, end, factor);
  }
  void project_tile(Tile& tile) const override { simd::project(this->map_.view, *this->receivers_, this->bias_, tile); }
};

}  // namespace penumbra::shadow_map
