// Many shadow rays at once: the loops that the ray-traced techniques and the reference share.
#pragma once

#include <span>
#include <utility>

#include "scenes/ray_scene.h"
#include "scenes/receivers.h"
#include "techniques/bases/light_sampling.h"

namespace penumbra {

/// Collects rays, drops those that miss the mesh's box, and traces the rest in full packets of 16, so that no lane
/// idles. `done(tag, hit)` is called once for every ray, not in the order of arrival.
template <class Tag, class Done>
class RayQueue {
 public:
  RayQueue(const RayScene& rays, Done done, bool alike) : rays_(rays), done_(std::move(done)), alike_(alike) {}

  void push(Tag tag, vec3 origin, vec3 direction, float far) {
    arriving_.set(arrived_, origin, direction, far);
    arriving_tags_[arrived_] = tag;
    if (++arrived_ == RayPacket::size) sift();
  }

  void flush() {
    sift();
    trace();
  }

 private:
  void sift() {
    const unsigned meets = arrived_ ? rays_.meets_box(arriving_, arrived_) : 0u;
    for (int i = 0; i < arrived_; ++i) {
      if (!(meets >> i & 1u)) {
        done_(arriving_tags_[i], false);
        continue;
      }
      waiting_.copy(waited_, arriving_, i);
      waiting_tags_[waited_] = arriving_tags_[i];
      if (++waited_ == RayPacket::size) trace();
    }
    arrived_ = 0;
  }

  void trace() {
    const unsigned hits = waited_ ? rays_.occluded(waiting_, waited_, alike_) : 0u;
    for (int i = 0; i < waited_; ++i) done_(waiting_tags_[i], (hits >> i & 1u) != 0);
    waited_ = 0;
  }

  const RayScene& rays_;
  Done done_;
  RayPacket arriving_ = {}, waiting_ = {};  // zeroed: unused lanes are computed too
  Tag arriving_tags_[RayPacket::size], waiting_tags_[RayPacket::size];
  int arrived_ = 0, waited_ = 0;
  bool alike_;
};

/// Deduces the type of the callback. `alike`: rays that come one after the other are (RayScene::occluded).
template <class Tag, class Done>
RayQueue<Tag, Done> make_ray_queue(const RayScene& rays, Done done, bool alike = false) {
  return {rays, std::move(done), alike};
}

/// Reflected radiance at albedo 1 of up to 16 receivers with equally many samples in the same order of strata. Ray j of
/// all receivers are traced together: neighbours ask the same stratum, so the rays are alike.
void estimate_packet(const RayScene& rays, const Receivers& receivers, std::span<const int> which,
                     std::span<const LightSample* const> samples, int rays_per_receiver, vec3* radiance);

}  // namespace penumbra
