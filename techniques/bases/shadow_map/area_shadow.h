// What all shadow-map techniques share: radiance = albedo * unshadowed radiance * visibility, the unshadowed part in
// closed form (bases/area_irradiance.h), visibility from a shadow map seen from the light's centre.
//
// Stages: lighting (unshadowed), map (rays), then those of the technique. The first two run when their input changed.
// Every step runs on the threads of the arena that it is called in; on how many changes no bit.
#pragma once

#include <array>
#include <atomic>

#include "techniques/bases/area_irradiance.h"
#include "techniques/bases/shadow_map/shadow_map.h"
#include "techniques/bases/stage_clock.h"
#include "techniques/registry.h"

namespace penumbra::shadow_map {

class AreaShadow : public Technique {
 public:
  explicit AreaShadow(const Parameters& parameters);
  AreaShadow(const Parameters& parameters, float region_bias);

  void prepare(const Scene& scene, const Light& light) override;
  void update(const Frame& frame) override;
  void shade(View<vec3> radiance) override;
  Footprint footprint() const override;
  std::map<std::string, std::size_t> counters() const override { return {{"vertices_off_map", outside_}}; }
  std::vector<Stage> stages() const override { return clock_.stages(); }

  /// Returns what the entries of all shadow-map techniques say alike, with the technique's `own` parameters.
  static Entry entry(const std::vector<Parameter>& own);

 protected:
  /// Makes what is derived from the map; called once for each.
  virtual void map_changed() {}
  /// Fills tile.visibility from x, y and depth.
  virtual void find_visibility(Tile& tile) = 0;
  /// Changes the image as a whole; called when all its tiles are done.
  virtual void finish(std::vector<float>& visibility) { (void)visibility; }
  virtual void find_unshadowed(const LampOutline& lamp, int begin, int end, float* factor) const;
  virtual void project_tile(Tile& tile) const { project(map_.view, *receivers_, bias_, tile); }
  /// Returns what numbers of a tile's rows and columns are multiples of.
  virtual int tile_multiple() const { return 1; }
  /// Counts the bytes of what map_changed() makes.
  virtual std::size_t derived_bytes() const { return 0; }

  /// Parts of find_visibility() whose times become stages: the mean over threads of their sums over tiles.
  enum Part { project_part, region_part, blocker_part, filter_part, parts };
  template <class Work>
  void timed(Part part, const Work& work) {
    const auto start = StageClock::Clock::now();
    work();
    part_ns_[part] += std::chrono::nanoseconds(StageClock::Clock::now() - start).count();
  }

  ShadowMap map_;
  const Receivers* receivers_ = nullptr;
  StageClock clock_;
  Bias bias_;
  LampOutline lamp_;
  vec3 emitted_{0.0f};

 private:
  void shade_tiles();
  void refresh(const Mesh& mesh, const Light& light, const Receivers& receivers, Changes changed);

  std::array<std::atomic<long long>, parts> part_ns_{};
  LightViewSettings settings_;
  RayScene rays_;
  std::size_t outside_ = 0;
  std::vector<float> unshadowed_, visibility_;
};

/// Declares the bias that grows with regions, of techniques that have such.
Parameter region_bias_parameter(double standard = 1.0);
/// Declares the factor on the filter region of techniques that make it as wide as the penumbra.
Parameter filter_scale_parameter();

}  // namespace penumbra::shadow_map
