// What all shadow-map techniques share: radiance = albedo * unshadowed radiance * visibility, the unshadowed part in
// closed form (bases/area_irradiance.h), visibility from a shadow map seen from the light's centre.
//
// Stages: lighting (unshadowed), map (rays), then those of the technique. The first two run when their input changed.
#pragma once

#include <array>
#include <atomic>
#include <functional>

#include "techniques/bases/area_irradiance.h"
#include "techniques/bases/stage_clock.h"
#include "techniques/parameters.h"
#include "techniques/pcss/shadow_map.h"

namespace penumbra::pcss {

class AreaShadow : public Technique {
 public:
  /// `parallel`: over tiles of receivers; otherwise one after the other.
  AreaShadow(const Parameters& parameters, bool parallel);

  void prepare(const Scene& scene) override;
  void update(const Frame& frame) override;
  void shade(View<vec3> radiance) override;
  Footprint footprint() const override;
  std::map<std::string, std::size_t> counters() const override { return {{"vertices_off_map", outside_}}; }
  std::vector<Stage> stages() const override { return clock_.stages(); }

  static std::vector<Parameter> parameters();

 protected:
  /// Once per new map: what is derived from it.
  virtual void map_changed() {}
  /// Fills tile.visibility from x, y and depth.
  virtual void find_visibility(Tile& tile) = 0;
  /// Once all tiles are done: the whole image.
  virtual void finish(std::vector<float>& visibility) { (void)visibility; }
  virtual void find_unshadowed(const LampOutline& lamp, int begin, int end, float* factor) const;
  virtual void project_tile(Tile& tile) const { project(map_.view, *receivers_, bias_, tile); }
  /// Tiles' rows and columns are multiples of this.
  virtual int tile_multiple() const { return 1; }
  /// Bytes of what map_changed() makes.
  virtual std::size_t derived_bytes() const { return 0; }

  /// Parts of find_visibility() whose times become stages: the mean over threads of their sums over tiles.
  enum Part { project_part, region_part, blocker_part, filter_part, parts };
  template <class Work>
  void timed(Part part, const Work& work) {
    const auto start = StageClock::Clock::now();
    work();
    part_ns_[part] += std::chrono::nanoseconds(StageClock::Clock::now() - start).count();
  }

  void for_ranges(int count, int grain, const std::function<void(int, int)>& work) const;

  ShadowMap map_;
  const Receivers* receivers_ = nullptr;
  StageClock clock_;
  bool parallel_;
  float bias_;  ///< texels
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

}  // namespace penumbra::pcss
