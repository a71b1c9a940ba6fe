// shadow-map-traced on the device: a thread a receiver walks all its rays over the map, whose own rays the host traces.
#include "techniques/shadow_map_traced/shadow_map_traced.h"

#include "cuda/kernels.h"
#include "cuda/lamp.h"
#include "cuda/shadow_map.h"

namespace penumbra::PENUMBRA_CUDA_NAMESPACE {

using shadow_map::Pattern;
using shadow_map_traced::Walking;

/// The lamp's points that every receiver turns for itself.
struct PointSpans {
  Pattern pattern;
  Span<const vec2> point;
};

__global__ void __launch_bounds__(threads)
    walk_map(shadow_map::LightView view, MapSpans map, shadow_map::Bias bias, Walking how, PointSpans points,
             ReceiverSpans receivers, Span<float> visibility) {
  const std::size_t i = global_thread();
  if (i >= visibility.size) return;
  const shadow_map::Projected at =
      shadow_map::project(view, bias, receivers.position[i], receivers.normal[i], receivers.touches[i] != 0);
  const int x = int(i % std::size_t(receivers.width)), y = int(i / std::size_t(receivers.width));
  float u, v;
  find_turn(points.pattern, x, y, u, v);
  visibility[i] = shadow_map_traced::share_of_rays(how, view, map, at, points.pattern, points.point,
                                                   int(points.point.size), u, v, shadow_map_traced::step_number(x, y));
  tally(60);
}

class TracedOnDevice final : public UnderLamp<shadow_map_traced::Traced> {
 public:
  using UnderLamp::UnderLamp;

 protected:
  void find_unshadowed(const LampOutline&, int, int, float*) const override {}  // by a kernel

  void upload(const Changes& changed) override {
    if (changed.receivers) visibility_.resize(receiver_count());
    if (changed.light) points_.upload(stream_, points());
    if (changed.light || changed.receivers) queue_light();
    if (changed.mesh || changed.light || changed.receivers) depth_.upload(stream_, map_.depth);
  }

  void queue() override {
    const MapSpans map{depth_.span(), map_.resolution(), map_.stride()};
    launch(stream_, PENUMBRA_KERNEL(walk_map), blocks_of_receivers(), threads, map_.view, map, bias_, how_,
           PointSpans{pattern(), points_.span()}, receivers(), visibility_.span());
    queue_compose(visibility_.span());
  }

  Footprint device_bytes() const override {
    return {0, points_.bytes() + light_bytes(), depth_.bytes() + visibility_.bytes()};
  }

 private:
  Buffer<vec2> points_;
  Buffer<float> depth_, visibility_;
};

void add_shadow_map_traced(Makers& makers) {
  makers["shadow-map-traced"] = maker<TracedOnDevice>();
}

}  // namespace penumbra::PENUMBRA_CUDA_NAMESPACE
