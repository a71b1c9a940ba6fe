// What the filters of binary visibility share: one ray from every receiver to the lamp's centre, then a filter over the
// image of what they found, and radiance = albedo * unshadowed radiance * visibility, the unshadowed part in closed
// form (bases/area_irradiance.h).
//
// Stages: lighting (unshadowed, when its input changed), visibility (rays), filter, compose.
#pragma once

#include "scenes/ray_scene.h"
#include "techniques/bases/area_irradiance.h"
#include "techniques/bases/instruction_set.h"
#include "techniques/bases/stage_clock.h"
#include "techniques/registry.h"
#include "techniques/visibility_filter/surface_bits.h"

namespace penumbra::visibility_filter {

class FilteredVisibility : public Technique {
 public:
  void prepare(const Scene& scene, const Light& light) override;
  void update(const Frame& frame) override;
  void shade(View<vec3> radiance) override;
  Footprint footprint() const override;
  std::vector<Stage> stages() const override { return clock_.stages(); }

 protected:
  /// Calls trace(), as a stage.
  void look();
  /// Fills pixels_: a ray from every receiver to the lamp's centre.
  virtual void trace();
  virtual void find_unshadowed();
  /// Fills visibility_ from pixels_.
  virtual void filter() = 0;
  /// Called with the scene at rest, and when receivers moved.
  virtual void receivers_moved(bool at_rest) { (void)at_rest; }

  RayScene rays_;
  const Receivers* receivers_ = nullptr;
  LampOutline lamp_;
  vec3 emitted_{0.0f};
  float lamp_area_ = 0.0f;  ///< m^2
  PixelMap pixels_;
  std::vector<float> unshadowed_, visibility_;

 private:
  void refresh(const Mesh& mesh, const Light& light, const Receivers& receivers, Changes changed);

  StageClock clock_;
};

/// What the entries of these techniques say alike.
Entry entry_of_filter(const char* name, const char* summary, const char* citation);

/// Fill `pixels` by packets of rays on all threads.
void trace_packets(const RayScene& rays, const Receivers& receivers, vec3 centre, PixelMap& pixels);
void find_unshadowed_vectors(const LampOutline& lamp, const Receivers& receivers, float* factor);

/// `Scalar` with packets of rays, vectors of receivers, and bits to filter with.
template <class Scalar>
class Packets : public Scalar {
 public:
  using Scalar::Scalar;
  std::string instruction_set() const override { return instruction_set_of_kernels(); }
  Footprint footprint() const override {
    Footprint all = Scalar::footprint();
    all.per_frame += bits_.bytes();
    return all;
  }

 protected:
  void trace() override { trace_packets(this->rays_, *this->receivers_, this->lamp_.centre, this->pixels_); }
  void find_unshadowed() override { find_unshadowed_vectors(this->lamp_, *this->receivers_, this->unshadowed_.data()); }

  SurfaceBits bits_;
};

}  // namespace penumbra::visibility_filter
