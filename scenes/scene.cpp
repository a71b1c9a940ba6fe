#include "scenes/scene.h"

#include <cmath>

namespace penumbra {
namespace {

vec3 turn_y(vec3 p, float angle) {
  const float c = std::cos(angle), s = std::sin(angle);
  return {c * p.x + s * p.z, p.y, c * p.z - s * p.x};
}

/// Where a point of the rest shape goes.
vec3 moved(const Motion& motion, const Bounds& rest, vec3 p, float angle) {
  const float height = std::max(rest.extent().y, 1e-20f), h = (p.y - rest.low.y) / height;
  switch (motion.kind) {
    case Motion::Kind::rigid:
      return turn_y(p, angle);
    case Motion::Kind::twist:
      return turn_y(p, angle * h);
    case Motion::Kind::bend: {  // about +z, from the ground up
      const float c = std::cos(angle * h), s = std::sin(angle * h);
      return {c * p.x - s * (p.y - rest.low.y), rest.low.y + s * p.x + c * (p.y - rest.low.y), p.z};
    }
    default:
      return p;
  }
}

}  // namespace

Animation::Animation(const Scene& scene)
    : scene_(scene),
      rest_(bounds(scene.mesh)),
      mesh_(scene.mesh),
      spheres_(scene.spheres),
      light_(scene.light),
      receivers_(scene.receivers) {
  if (deforms() && !mesh_.empty()) carrier_ = SphereCarrier(mesh_, spheres_, scene.motion.carry);
}

bool Animation::deforms() const {
  return scene_.motion.kind != Motion::Kind::none && scene_.motion.kind != Motion::Kind::rotate_light;
}

Frame Animation::frame(int index) {
  const Motion& motion = scene_.motion;
  Changes changed;
  if (motion.kind == Motion::Kind::rotate_light) {
    changed.light = true;
    if (auto* environment = std::get_if<Environment>(&light_))
      environment->rotation =
          environment_of(scene_.light)->rotation + double(motion.amount) * index / double(motion.period);
    if (auto* area = std::get_if<AreaLight>(&light_)) {
      *area = *area_light_of(scene_.light);
      const float angle = motion.amount * float(index) / motion.period;
      for (vec3* v : {&area->centre, &area->edge_u, &area->edge_v, &area->normal}) *v = turn_y(*v, angle);
    }
  } else if (deforms()) {
    changed.mesh = changed.spheres = true;
    const float angle = motion.amount * float(std::sin(2.0 * pi * index / motion.period));
    for (std::size_t i = 0; i < mesh_.positions.size(); ++i)
      mesh_.positions[i] = moved(motion, rest_, scene_.mesh.positions[i], angle);
    if (!mesh_.empty()) carrier_.move(mesh_, spheres_);
    else
      for (std::size_t i = 0; i < spheres_.size(); ++i)
        spheres_.spheres[i].centre = moved(motion, rest_, scene_.spheres.spheres[i].centre, angle);
    if (!std::holds_alternative<PlaneGrid>(scene_.receiver_spec.kind)) {
      changed.receivers = true;
      receivers_ = make_receivers(scene_.receiver_spec, mesh_);
    }
  }
  return {double(index), mesh_, spheres_, light_, receivers_, changed};
}

}  // namespace penumbra
