#include "techniques/bases/shadow_map/area_shadow.h"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/task_arena.h>

#include <algorithm>

#include "techniques/bases/for_ranges.h"

namespace penumbra::shadow_map {

AreaShadow::AreaShadow(const Parameters& p, float region_bias) : bias_{float(p.number("bias")), region_bias} {
  settings_.resolution = p.integer("map");
  settings_.perspective = p.text("light_view") == "perspective";
  settings_.light_scale = p.number("light_scale");
  settings_.margin = p.number("margin");
}

AreaShadow::AreaShadow(const Parameters& p) : AreaShadow(p, 0.0f) {}

Entry AreaShadow::entry(const std::vector<Parameter>& own) {
  Entry entry;
  entry.lights = {false, true};
  entry.reads_spheres = [](const Parameters&) { return false; };
  entry.parameters = {
      integer_parameter("map", 1024, 1, 8192, "map texels", "edge of the shadow map"),
      choice_parameter("light_view", {"perspective", "orthographic"},
                       "how the map sees the scene; orthographic: parallel rays, for a light that is far away"),
      number_parameter("light_scale", 1.0, 0.0, 16.0, "",
                       "factor on the light's edges when regions are made; 0: a point, 2: the doubled width of "
                       "common shaders"),
      number_parameter("margin", 1.0, 0.0, 4.0, "region widths", "how far the map reaches past the occluder"),
      number_parameter("bias", 1.0, 0.0, 100.0, "map texels", "depth bias of receivers on triangles of the mesh")};
  entry.parameters.insert(entry.parameters.end(), own.begin(), own.end());
  entry.knobs = {{"map", {256, 512, 1024, 2048}}};  // no more is always better: the bias shrinks with the texels
  entry.errs_by = "one view";
  entry.small.set("map", 128);
  entry.parity = 1e-3;  // a rounding may move a region's edge by a texel
  return entry;
}

Parameter region_bias_parameter(double standard) {
  return number_parameter("region_bias", standard, 0.0, 4.0, "half regions",
                          "depth bias that grows with the region; 1: what a receiver's own plane rises in it");
}

Parameter filter_scale_parameter() {
  return number_parameter("filter_scale", 1.0, 0.0, 16.0, "", "c: filter width over penumbra width");
}

void AreaShadow::find_unshadowed(const LampOutline& lamp, int begin, int end, float* factor) const {
  for (int i = begin; i < end; ++i)
    factor[i] = receivers_->valid(i) ? form_factor(lamp, receivers_->position[i], receivers_->normal[i]) : 0.0f;
}

void AreaShadow::refresh(const Mesh& mesh, const Light& light, const Receivers& receivers, Changes changed) {
  const AreaLight& lamp = *area_light_of(light);
  receivers_ = &receivers;
  emitted_ = lamp.radiance;
  if (changed.light) lamp_ = make_outline(lamp);
  if (changed.mesh) rays_.build(mesh);
  clock_.reset();
  if (changed.light || changed.receivers)
    clock_.measure("lighting", [&] {
      unshadowed_.resize(std::size_t(receivers.size()));
      for_ranges(receivers.size(), 4096,
                 [&](int begin, int end) { find_unshadowed(lamp_, begin, end, unshadowed_.data()); });
    });
  if (!changed.mesh && !changed.light && !changed.receivers) return;
  clock_.measure("map", [&] {
    map_.view = make_light_view(lamp, mesh, receivers, settings_, outside_);
    trace(rays_, map_);
  });
  map_changed();
}

void AreaShadow::prepare(const Scene& scene, const Light& light) {
  refresh(scene.mesh, light, scene.receivers, {true, true, true, true});
}

void AreaShadow::update(const Frame& frame) {
  refresh(frame.mesh, frame.light, frame.receivers, frame.changed);
}

void AreaShadow::shade_tiles() {
  const int width = receivers_->width, height = receivers_->height, unit = tile_multiple();
  const int columns = (64 + unit - 1) / unit * unit, rows = (32 + unit - 1) / unit * unit;
  const int across = (width + columns - 1) / columns, down = (height + rows - 1) / rows;
  tbb::enumerable_thread_specific<Tile> tiles;
  for_ranges(across * down, 1, [&](int begin, int end) {
    Tile& tile = tiles.local();
    for (int k = begin; k < end; ++k) {
      const int column = k % across * columns, row = k / across * rows;
      tile.place(column, row, std::min(columns, width - column), std::min(rows, height - row));
      timed(project_part, [&] { project_tile(tile); });
      find_visibility(tile);
      for (int r = 0; r < tile.rows; ++r)
        std::copy_n(tile.visibility.begin() + std::ptrdiff_t(r) * tile.columns, tile.columns,
                    visibility_.begin() + std::ptrdiff_t(tile.first(r, width)));
    }
  });
}

void AreaShadow::shade(View<vec3> radiance) {
  visibility_.resize(std::size_t(receivers_->size()));
  for (auto& ns : part_ns_) ns = 0;
  shade_tiles();
  const int threads = tbb::this_task_arena::max_concurrency();
  constexpr const char* names[] = {"project", "regions", "blockers", "filter"};
  for (int part = 0; part < parts; ++part)
    if (part_ns_[part] > 0) clock_.set(names[part], 1e-6 * double(part_ns_[part]) / threads);
  finish(visibility_);
  clock_.measure("compose", [&] {
    for_ranges(receivers_->size(), 4096, [&](int begin, int end) {
      for (int i = begin; i < end; ++i)
        radiance[i] = receivers_->albedo[i] * (unshadowed_[i] * visibility_[i] * emitted_);
    });
  });
}

Footprint AreaShadow::footprint() const {
  return {0, rays_.bytes() + unshadowed_.size() * sizeof(float),
          map_.depth.size() * sizeof(float) + derived_bytes() + visibility_.size() * sizeof(float)};
}

}  // namespace penumbra::shadow_map
