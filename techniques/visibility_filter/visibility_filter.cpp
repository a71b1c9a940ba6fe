#include "techniques/visibility_filter/visibility_filter.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "techniques/bases/for_ranges.h"
#include "techniques/bases/shadow_map/kernel.h"

namespace penumbra::visibility_filter {
namespace {

/// Shadow rays end just before the lamp.
constexpr float before_lamp = 1.0f - 1e-4f;

/// Writes what a ray over `distance` to the lamp found: its first hit, or infinity. Pixels that show nothing are lit.
void write(const Receivers& receivers, std::size_t i, float distance, float hit, PixelMap& pixels) {
  const bool seen = receivers.valid(int(i));
  pixels.depth[i] = seen ? distance : std::numeric_limits<float>::quiet_NaN();
  pixels.caster[i] = seen && hit < distance * before_lamp ? hit : std::numeric_limits<float>::infinity();
  pixels.open[i] = pixels.caster[i] == std::numeric_limits<float>::infinity();
}

}  // namespace

void FilteredVisibility::trace() {
  for (int i = 0; i < receivers_->size(); ++i) {
    const vec3 from = receivers_->ray_origin(i), to = lamp_.centre - from;
    const float distance = glm::length(to);
    const bool away = receivers_->valid(i) && distance > 0.0f;
    const float hit = away ? rays_.intersect(from, to / distance).distance : std::numeric_limits<float>::infinity();
    write(*receivers_, std::size_t(i), distance, hit, pixels_);
  }
}

void FilteredVisibility::find_unshadowed() {
  for (int i = 0; i < receivers_->size(); ++i)
    unshadowed_[i] = receivers_->valid(i) ? form_factor(lamp_, receivers_->position[i], receivers_->normal[i]) : 0.0f;
}

void trace_packets(const RayScene& rays, const Receivers& receivers, vec3 centre, PixelMap& pixels) {
  const int across = (receivers.width + 3) / 4, down = (receivers.height + 3) / 4;
  for_ranges(across * down, 16, [&](int begin, int end) {
    RayPacket packet = {};
    std::size_t which[RayPacket::size];
    float distance[RayPacket::size], hit[RayPacket::size];
    for (int tile = begin; tile < end; ++tile) {
      int count = 0;
      const int x0 = tile % across * 4, y0 = tile / across * 4;
      for (int y = y0; y < std::min(y0 + 4, receivers.height); ++y)
        for (int x = x0; x < std::min(x0 + 4, receivers.width); ++x) {
          const int i = y * receivers.width + x;
          const vec3 from = receivers.ray_origin(i), to = centre - from;
          const float length = glm::length(to);
          if (!receivers.valid(i) || !(length > 0.0f)) {
            write(receivers, std::size_t(i), length, std::numeric_limits<float>::infinity(), pixels);
            continue;
          }
          packet.set(count, from, to / length, length);
          distance[count] = length, which[count++] = std::size_t(i);
        }
      if (count > 0) rays.first_hits(packet, count, hit);
      for (int k = 0; k < count; ++k) write(receivers, which[k], distance[k], hit[k], pixels);
    }
  });
}

void find_unshadowed_vectors(const LampOutline& lamp, const Receivers& receivers, float* factor) {
  for_ranges(receivers.size(), 4096,
             [&](int begin, int end) { shadow_map::simd::find_unshadowed(lamp, receivers, begin, end, factor); });
}

void FilteredVisibility::refresh(const Mesh& mesh, const Light& light, const Receivers& receivers, Changes changed) {
  const AreaLight& lamp = *area_light_of(light);
  receivers_ = &receivers;
  emitted_ = lamp.radiance;
  if (changed.light) lamp_ = make_outline(lamp), lamp_area_ = float(lamp.area());
  if (changed.mesh) rays_.move(mesh);
  clock_.reset();
  if (changed.light || changed.receivers)
    clock_.measure("lighting", [&] {
      unshadowed_.resize(std::size_t(receivers.size()));
      find_unshadowed();
    });
  pixels_.resize(receivers.width, receivers.height);
  visibility_.resize(std::size_t(receivers.size()));
}

void FilteredVisibility::prepare(const Scene& scene, const Light& light) {
  rays_.build(scene.mesh);
  refresh(scene.mesh, light, scene.receivers, {false, false, true, true});
  receivers_moved(true);
}

void FilteredVisibility::update(const Frame& frame) {
  refresh(frame.mesh, frame.light, frame.receivers, frame.changed);
  if (frame.changed.receivers || frame.changed.light) receivers_moved(false);
}

void FilteredVisibility::look() {
  clock_.measure("visibility", [&] { trace(); });
}

void FilteredVisibility::shade(View<vec3> radiance) {
  look();
  clock_.measure("filter", [&] { filter(); });
  clock_.measure("compose", [&] {
    for_ranges(receivers_->size(), 4096, [&](int begin, int end) {
      for (int i = begin; i < end; ++i)
        radiance[i] = receivers_->albedo[i] * (unshadowed_[i] * visibility_[i] * emitted_);
    });
  });
}

Footprint FilteredVisibility::footprint() const {
  const std::size_t floats = unshadowed_.size() + visibility_.size() + pixels_.depth.size() + pixels_.caster.size();
  return {0, rays_.bytes(), floats * sizeof(float) + pixels_.open.size()};
}

Entry entry_of_filter(const char* name, const char* summary, const char* citation) {
  Entry entry;
  entry.name = name, entry.summary = summary, entry.citation = citation;
  entry.lights = {false, true};
  entry.reads_spheres = [](const Parameters&) { return false; };
  entry.errs_by = "one ray";
  entry.parity = 1e-3;    // packets and single rays may round an edge differently
  entry.reach = 1 << 20;  // the scene's extent, and with it every width, depends on all that is seen
  return entry;
}

}  // namespace penumbra::visibility_filter
