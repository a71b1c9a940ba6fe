// Few shadow rays per pixel through a ratio estimator (Heitz, Hill & McGuire 2018): of stochastic shadows only the
// visible share is taken, S / U with both sums filtered alike (ratio_filter.h), and the light itself is exact:
//   B = albedo x unshadowed radiance x S / U
// The unshadowed part is a closed form for lamps (bases/area_irradiance.h) and a table for environments
// (bases/irradiance_table.h). Neighbouring pixels ask different points of the light (pattern.h); the filter is part of
// the penumbra wide, which a few blocked rays, followed to their casters, tell (tiles.h), and stays on its surface
// (surface.h). Vertices of a mesh are no image: each has the ratio of its own sums. Where U is 0, no point that was
// asked lies above the horizon, and what little is unshadowed counts as visible.
//
// Stages: lighting and surface (when their input changed), rays, filter, compose.
//   scalar: one rtcOccluded1 a ray, then the sums as they are written.
//   simd:   rays in packets of 16, pixels in vectors.
#include <tbb/enumerable_thread_specific.h>

#include <bit>
#include <cmath>

#include "scenes/ray_scene.h"
#include "techniques/bases/area_irradiance.h"
#include "techniques/bases/for_ranges.h"
#include "techniques/bases/instruction_set.h"
#include "techniques/bases/ray_packets.h"
#include "techniques/bases/shadow_map/kernel.h"
#include "techniques/bases/stage_clock.h"
#include "techniques/ray_traced_denoised/light_rays.h"
#include "techniques/ray_traced_denoised/ratio_filter.h"
#include "techniques/ray_traced_denoised/tiles.h"
#include "techniques/registry.h"

namespace penumbra {
namespace ray_traced_denoised {
namespace {

constexpr int tile_size = tile_edge * tile_edge;

constexpr int most_casters = 4;  // that are looked for in a tile

/// Rays of the pixels of a tile that are seen, and which of them are blocked.
struct TileRays {
  int count = 0;
  int pixel[tile_size];
  std::uint64_t blocked[tile_size];
  std::size_t per_pixel = 0;
  std::vector<Ray> rays;  ///< those of the first pixel, then those of the second

  Ray* of(int p) { return &rays[std::size_t(p) * per_pixel]; }
  const Ray* of(int p) const { return &rays[std::size_t(p) * per_pixel]; }

  /// Blocked rays that are followed to their casters: the first of up to most_casters pixels, evenly among those that
  /// have any. Calls use(pixel, ray).
  template <class Use>
  void for_followed(const Use& use) const {
    int which[tile_size], shadowed = 0;
    for (int p = 0; p < count; ++p)
      if (blocked[p] != 0) which[shadowed++] = p;
    const int followed = std::min(shadowed, most_casters);
    for (int k = 0; k < followed; ++k) {
      const int p = which[k * shadowed / followed];
      use(p, std::countr_zero(blocked[p]));
    }
  }
};

/// The penumbra of a tile: the mean of those of its casters.
struct Casters {
  float sum = 0.0f, count = 0.0f;

  /// One that a ray meets after `t` lengths of its direction; infinity: it slipped through.
  void add(const LightRays& light, float t) {
    if (t < std::numeric_limits<float>::infinity()) sum += light.penumbra(t), count += 1.0f;
  }
  float penumbra() const { return count > 0.0f ? sum / count : std::numeric_limits<float>::infinity(); }
};

class Denoised : public Technique {
 public:
  explicit Denoised(const Parameters& p)
      : count_(p.integer("rays")),
        most_(float(p.integer("most"))),
        seed_(std::uint64_t(p.integer("seed"))),
        share_(float(p.number("share") / std::sqrt(double(count_)))) {}

  void prepare(const Scene& scene, const Light& light) override {
    rays_.build(scene.mesh);
    refresh(light, scene.receivers, {false, false, true, true});
  }

  void update(const Frame& frame) override {
    if (frame.changed.mesh) rays_.move(frame.mesh);
    refresh(frame.light, frame.receivers, frame.changed);
  }

  void shade(View<vec3> radiance) override {
    clock_.measure("rays", [&] {
      tiles_.resize(receivers_->width, receivers_->height);
      trace();
    });
    clock_.measure("filter", [&] {
      find_extents();
      for (int c = 0; c < light_.channels(); ++c) filter(c);
    });
    clock_.measure("compose", [&] { compose(radiance); });
  }

  Footprint footprint() const override {
    std::size_t planes = extent_.bytes() + row_means_.seen.bytes() + row_means_.all.bytes();
    for (int c = 0; c < light_.channels(); ++c)
      planes += sums_[c].seen.bytes() + sums_[c].all.bytes() + share_of_[c].bytes() + unshadowed_[c].bytes();
    return {0, rays_.bytes() + light_.bytes() + surfaces_.bytes(), planes + tiles_.bytes()};
  }

  std::vector<Stage> stages() const override { return clock_.stages(); }

 protected:
  virtual void trace() {
    TileRays tile;
    for (int k = 0; k < tiles_.size(); ++k) {
      begin_tile(k, tile);
      for (int p = 0; p < tile.count; ++p) {
        const vec3 origin = receivers_->ray_origin(tile.pixel[p]);
        const Ray* rays = tile.of(p);
        for (int j = 0; j < count_; ++j)
          if (rays[j].weight != vec3(0.0f) && rays_.occluded(origin, rays[j].direction, rays[j].end))
            tile.blocked[p] |= std::uint64_t(1) << j;
      }
      finish_tile(k, tile);
    }
  }

  virtual void light_lamp() {
    for (int i = 0; i < receivers_->size(); ++i)
      unshadowed_[0][std::size_t(i)] =
          receivers_->valid(i) ? form_factor(lamp_, receivers_->position[i], receivers_->normal[i]) : 0.0f;
  }

  virtual void filter(int channel) {
    for (int y = 0; y < surfaces_.height; ++y) filter_row(surfaces_, extent_, most_, sums_[channel], y, row_means_);
    for (int y = 0; y < surfaces_.height; ++y)
      filter_columns(surfaces_, extent_, most_, row_means_, y, share_of_[channel]);
  }

  /// Makes the rays of a tile's pixels; none is blocked yet. Pixels that show nothing have none.
  void begin_tile(int k, TileRays& tile) const {
    tile.count = 0;
    tile.per_pixel = std::size_t(count_);
    tile.rays.resize(tile_size * tile.per_pixel);
    const int x0 = k % tiles_.columns * tile_edge, y0 = k / tiles_.columns * tile_edge;
    for (int y = y0; y < std::min(y0 + tile_edge, receivers_->height); ++y)
      for (int x = x0; x < std::min(x0 + tile_edge, receivers_->width); ++x) {
        const int i = y * receivers_->width + x;
        if (!receivers_->valid(i)) continue;
        light_.make(*receivers_, i, place_in_pattern(x, y), tile.of(tile.count));
        tile.blocked[tile.count] = 0;
        tile.pixel[tile.count++] = i;
      }
  }

  /// Follows a few rays to their casters, one by one: they point all over the light.
  Casters find_casters(const TileRays& tile) const {
    Casters casters;
    tile.for_followed([&](int p, int j) {
      const vec3 origin = receivers_->ray_origin(tile.pixel[p]);
      casters.add(light_, rays_.intersect(origin, tile.of(p)[j].direction).distance);
    });
    return casters;
  }

  /// Sums up, and notes what the filter must know.
  void finish_tile(int k, const TileRays& tile) {
    bool lit = false, dark = false;
    for (int p = 0; p < tile.count; ++p) {
      const Ray* rays = tile.of(p);
      vec3 seen(0.0f), all(0.0f);
      for (int j = 0; j < count_; ++j) {
        all += rays[j].weight;
        if ((tile.blocked[p] >> j & 1) == 0) seen += rays[j].weight;
      }
      for (int c = 0; c < light_.channels(); ++c)
        sums_[c].seen[std::size_t(tile.pixel[p])] = seen[c], sums_[c].all[std::size_t(tile.pixel[p])] = all[c];
      dark |= tile.blocked[p] != 0, lit |= seen != vec3(0.0f);
    }
    tiles_.lit[std::size_t(k)] = lit, tiles_.dark[std::size_t(k)] = dark;
    tiles_.penumbra[std::size_t(k)] = find_casters(tile).penumbra();
  }

  void compose(View<vec3> radiance) const {
    const int channels = light_.channels();
    for_ranges(receivers_->size(), 4096, [&](int begin, int end) {
      for (int i = begin; i < end; ++i) {
        const auto at = std::size_t(i);
        vec3 reflected(unshadowed_[0][at] * share_of_[0][at]);
        for (int c = 1; c < channels; ++c) reflected[c] = unshadowed_[c][at] * share_of_[c][at];
        radiance[at] = receivers_->valid(i) ? receivers_->albedo[at] * (emitted_ * reflected) : vec3(0.0f);
      }
    });
  }

  int count_;
  RayScene rays_;
  const Receivers* receivers_ = nullptr;
  LampOutline lamp_;
  LightRays light_;
  SurfaceMap surfaces_;
  TileMap tiles_;
  Plane extent_;  ///< of every pixel's box, m
  Sums sums_[3], row_means_;
  Plane share_of_[3], unshadowed_[3];
  float most_;

 private:
  void refresh(const Light& light, const Receivers& receivers, Changes changed) {
    receivers_ = &receivers;
    clock_.reset();
    if (changed.light || changed.receivers) clock_.measure("lighting", [&] { set_light(light); });
    if (changed.receivers) clock_.measure("surface", [&] { find_surfaces(receivers, surfaces_); });
  }

  void set_light(const Light& light) {
    const auto n = std::size_t(receivers_->size());
    light_ = LightRays(light, *receivers_, count_, seed_);
    extent_.resize(n), row_means_.seen.resize(n), row_means_.all.resize(n);
    for (int c = 0; c < light_.channels(); ++c)
      sums_[c].seen.resize(n), sums_[c].all.resize(n), share_of_[c].resize(n), unshadowed_[c].resize(n);
    if (const AreaLight* lamp = area_light_of(light)) {
      emitted_ = lamp->radiance;
      lamp_ = make_outline(*lamp);
      return light_lamp();
    }
    emitted_ = vec3(1.0f);
    for_ranges(receivers_->size(), 1024, [&](int begin, int end) {
      for (int i = begin; i < end; ++i) {
        const vec3 all = receivers_->valid(i) ? light_.unshadowed(*receivers_, i) : vec3(0.0f);
        for (int c = 0; c < 3; ++c) unshadowed_[c][std::size_t(i)] = all[c];
      }
    });
  }

  void find_extents() {
    const int reach = (int(most_) / 2 + tile_edge - 1) / tile_edge;
    const std::vector<float> penumbra = spread(tiles_, reach);
    for_ranges(receivers_->height, 16, [&](int begin, int end) {
      for (int y = begin; y < end; ++y) {
        const float* row = penumbra.data() + std::size_t(y / tile_edge) * std::size_t(tiles_.columns);
        float* extent = extent_.data() + std::size_t(y) * std::size_t(receivers_->width);
        for (int x = 0; x < receivers_->width; ++x) extent[x] = share_ * row[x / tile_edge];
      }
    });
  }

  std::uint64_t seed_;
  float share_;  ///< of the penumbra's width, for these rays
  vec3 emitted_{0.0f};
  StageClock clock_;
};

class DenoisedSimd final : public Denoised {
 public:
  using Denoised::Denoised;
  std::string instruction_set() const override { return instruction_set_of_kernels(); }

 protected:
  void light_lamp() override {
    for_ranges(receivers_->size(), 4096, [&](int begin, int end) {
      shadow_map::simd::find_unshadowed(lamp_, *receivers_, begin, end, unshadowed_[0].data());
    });
  }

  void trace() override {
    tbb::enumerable_thread_specific<TileRays> scratch;
    for_ranges(tiles_.size(), 8, [&](int begin, int end) {
      TileRays& tile = scratch.local();
      for (int k = begin; k < end; ++k) {
        begin_tile(k, tile);
        trace_tile(tile);
        finish_tile(k, tile);
      }
    });
  }

  void filter(int channel) override {
    for_ranges(surfaces_.height, 8, [&](int begin, int end) {
      for (int y = begin; y < end; ++y) simd::filter_row(surfaces_, extent_, most_, sums_[channel], y, row_means_);
    });
    for_ranges(surfaces_.height, 8, [&](int begin, int end) {
      for (int y = begin; y < end; ++y)
        simd::filter_columns(surfaces_, extent_, most_, row_means_, y, share_of_[channel]);
    });
  }

 private:
  void trace_tile(TileRays& tile) const {
    struct Tag {
      int pixel, ray;
    };
    auto queue = make_ray_queue<Tag>(rays_, [&](Tag tag, bool hit) {
      if (hit) tile.blocked[tag.pixel] |= std::uint64_t(1) << tag.ray;
    });
    vec3 origin[tile_size];
    for (int p = 0; p < tile.count; ++p) origin[p] = receivers_->ray_origin(tile.pixel[p]);
    for (int j = 0; j < count_; ++j)
      for (int p = 0; p < tile.count; ++p) {
        const Ray& ray = tile.of(p)[j];
        if (ray.weight != vec3(0.0f)) queue.push({p, j}, origin[p], ray.direction, ray.end);
      }
    queue.flush();
  }
};

}  // namespace
}  // namespace ray_traced_denoised

void register_ray_traced_denoised(Registry& registry) {
  using namespace ray_traced_denoised;
  Entry entry;
  entry.name = "ray-traced-denoised";
  entry.summary = "few shadow rays per pixel, their visible share filtered: ratio estimator";
  entry.citation = "Heitz, Hill & McGuire 2018; Keller & Heidrich 2001";
  entry.lights = {true, true};
  entry.reads_spheres = [](const Parameters&) { return false; };
  entry.parameters = {
      integer_parameter("rays", 4, 1, most_rays, "rays", "shadow rays per receiver"),
      integer_parameter("seed", 1, 0, 1 << 30, "", "scrambles the points of the light: same seed, same image"),
      number_parameter(
          "share", 1.2, 0.0, 8.0, "",
          "width of the filter as part of the penumbra's, with one ray; more need less, by 1 / sqrt(rays)"),
      integer_parameter("most", 8, 1, widest_box, "pixels", "widest filter"),
  };
  entry.knobs = {{"rays", {1, 2, 3, 4, 6, 8, 12, 16, 24, 32, 48, 64}, true}, {"most", {1, 8}}};
  entry.errs_by = "noise and blur";
  entry.parity = 1e-3;                           // packets and single rays may round an edge differently
  entry.reach = widest_box / 2 + 3 * tile_edge;  // the box, and the tiles whose casters make it
  add_pair<Denoised, DenoisedSimd>(registry, std::move(entry));
}

}  // namespace penumbra
