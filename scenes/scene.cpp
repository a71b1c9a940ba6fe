#include "scenes/scene.h"

#include <algorithm>
#include <cmath>

namespace penumbra {
namespace {

vec3 turn_y(vec3 p, float angle) {
  const float c = std::cos(angle), s = std::sin(angle);
  return {c * p.x + s * p.z, p.y, c * p.z - s * p.x};
}

/// x and z of a motion's axis.
vec3 axis_of(const Motion& motion) {
  return {motion.centre.x, 0.0f, motion.centre.z};
}

/// Of what swings about its rest.
float swing(const Motion& motion, int index) {
  return motion.amount * float(std::sin(2.0 * pi * index / motion.period));
}

/// `light` is a copy of the one at rest, turned before.
void turn_light(const Light& rest, const Motion& motion, int index, Light& light) {
  if (auto* environment = std::get_if<Environment>(&light))
    environment->rotation = environment_of(rest)->rotation + double(motion.amount) * index / double(motion.period);
  if (auto* area = std::get_if<AreaLight>(&light)) {
    *area = *area_light_of(rest);
    const float angle = motion.amount * float(index) / motion.period;
    const vec3 axis = axis_of(motion);
    area->centre = axis + turn_y(area->centre - axis, angle);
    for (vec3* v : {&area->edge_u, &area->edge_v, &area->normal}) *v = turn_y(*v, angle);
  }
  if (auto* several = std::get_if<Lights>(&light))
    for (std::size_t k = 0; k < several->each.size(); ++k)
      turn_light(each_of(rest)[k], motion, index, several->each[k]);
}

/// Where a point of the rest shape goes.
vec3 moved(const Motion& motion, const Bounds& rest, vec3 p, float angle) {
  const float height = std::max(rest.extent().y, 1e-20f), up = p.y - rest.low.y, h = up / height;
  const vec3 axis = axis_of(motion), beside = p - axis;
  switch (motion.kind) {
    case Motion::Kind::rigid:
      return axis + turn_y(beside, angle);
    case Motion::Kind::twist:
      return axis + turn_y(beside, angle * h);
    case Motion::Kind::bend: {  // about +z, from the ground up
      const float c = std::cos(angle * h), s = std::sin(angle * h);
      return {axis.x + c * beside.x - s * up, rest.low.y + s * beside.x + c * up, p.z};
    }
    default:
      return p;
  }
}

/// Where a normal of the rest shape goes: by the cofactors of the motion's derivative.
vec3 moved_normal(const Motion& motion, const Bounds& rest, vec3 p, vec3 normal, float angle) {
  const float step = 1e-2f * std::max({rest.extent().x, rest.extent().y, rest.extent().z, 1e-20f});
  dvec3 d[3];
  for (int c = 0; c < 3; ++c) {
    vec3 beside(0.0f);
    beside[c] = step;
    d[c] = dvec3(moved(motion, rest, p + beside, angle)) - dvec3(moved(motion, rest, p - beside, angle));
  }
  const dvec3 n = double(normal.x) * glm::cross(d[1], d[2]) + double(normal.y) * glm::cross(d[2], d[0]) +
                  double(normal.z) * glm::cross(d[0], d[1]);
  const double length = glm::length(n);
  return length > 0.0 ? vec3(n / length) : normal;
}

}  // namespace

Animation::Animation(const Scene& scene) : scene_(scene), rest_(bounds(scene.mesh)) {
  if (scene.motion.kind == Motion::Kind::rotate_light) light_ = scene.light;
  if (!deforms()) return;
  mesh_ = scene.mesh, spheres_ = scene.spheres;
  if (!mesh_.empty() && !spheres_.empty()) carrier_ = SphereCarrier(mesh_, spheres_, scene.motion.carry);
}

ReceiverSpec Animation::receiver_spec(int index) const {
  ReceiverSpec spec = scene_.receiver_spec;
  auto* camera = std::get_if<Camera>(&spec.kind);
  if (!camera || !scene_.motion.moves_camera()) return spec;
  const float by = swing(scene_.motion, index);
  const vec3 away = camera->eye - camera->target;
  camera->eye = camera->target + (scene_.motion.kind == Motion::Kind::orbit ? turn_y(away, by) : std::exp(by) * away);
  return spec;
}

Frame Animation::frame(int index) {
  const Motion& motion = scene_.motion;
  Changes changed;
  if (motion.kind == Motion::Kind::rotate_light) {
    changed.light = true;
    turn_light(scene_.light, motion, index, light_);
  } else if (deforms()) {
    changed.mesh = changed.spheres = true;
    const float angle = swing(motion, index);
    for (std::size_t i = 0; i < mesh_.positions.size(); ++i)
      mesh_.positions[i] = moved(motion, rest_, scene_.mesh.positions[i], angle);
    for (std::size_t i = 0; i < mesh_.normals.size(); ++i)
      mesh_.normals[i] = moved_normal(motion, rest_, scene_.mesh.positions[i], scene_.mesh.normals[i], angle);
    if (!mesh_.empty()) carrier_.move(mesh_, spheres_);
    else
      for (std::size_t i = 0; i < spheres_.size(); ++i)
        spheres_.spheres[i].centre = moved(motion, rest_, scene_.spheres.spheres[i].centre, angle);
    if (!std::holds_alternative<PlaneGrid>(scene_.receiver_spec.kind)) {
      changed.receivers = true;
      receivers_ = make_receivers(scene_.receiver_spec, mesh_);
    }
  }
  if (motion.moves_camera()) {
    changed.receivers = true;
    receivers_ = make_receivers(receiver_spec(index), scene_.mesh);
  }
  return {double(index),
          changed.mesh ? mesh_ : scene_.mesh,
          changed.spheres ? spheres_ : scene_.spheres,
          changed.light ? light_ : scene_.light,
          changed.receivers ? receivers_ : scene_.receivers,
          changed};
}

}  // namespace penumbra
