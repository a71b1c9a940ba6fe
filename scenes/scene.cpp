#include "scenes/scene.h"

#include <algorithm>
#include <cmath>
#include <span>

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
float phase_of(const Motion& motion, int index) {
  return float(std::sin(2.0 * pi * index / motion.period));
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
vec3 moved(const Motion& motion, const Bounds& rest, vec3 p, float phase) {
  const float angle = motion.amount * phase;
  const float height = std::max(rest.extent().y, 1e-20f), up = p.y - rest.low.y, h = up / height;
  const vec3 axis = axis_of(motion), beside = p - axis, travelled = phase * motion.travel;
  switch (motion.kind) {
    case Motion::Kind::rigid:
      return axis + turn_y(beside, angle) + travelled;
    case Motion::Kind::twist:
      return axis + turn_y(beside, angle * h) + travelled;
    case Motion::Kind::bend: {  // about +z, from the ground up
      const float c = std::cos(angle * h), s = std::sin(angle * h);
      return vec3(axis.x + c * beside.x - s * up, rest.low.y + s * beside.x + c * up, p.z) + travelled;
    }
    default:
      return p;
  }
}

/// Where a normal of the rest shape goes: by the cofactors of the motion's derivative.
vec3 moved_normal(const Motion& motion, const Bounds& rest, vec3 p, vec3 normal, float phase) {
  const float step = 1e-2f * std::max({rest.extent().x, rest.extent().y, rest.extent().z, 1e-20f});
  dvec3 d[3];
  for (int c = 0; c < 3; ++c) {
    vec3 beside(0.0f);
    beside[c] = step;
    d[c] = dvec3(moved(motion, rest, p + beside, phase)) - dvec3(moved(motion, rest, p - beside, phase));
  }
  const dvec3 n = double(normal.x) * glm::cross(d[1], d[2]) + double(normal.y) * glm::cross(d[2], d[0]) +
                  double(normal.z) * glm::cross(d[0], d[1]);
  const double length = glm::length(n);
  return length > 0.0 ? vec3(n / length) : normal;
}

template <class T>
std::vector<T> taken(const std::vector<T>& from, const Entity::Range& range) {
  const std::span<const T> part = std::span(from).subspan(range.first, range.count);
  return {part.begin(), part.end()};
}

/// An entity's own mesh.
Mesh part_of(const Mesh& all, const Entity& entity) {
  Mesh mesh;
  mesh.origin = all.origin;
  mesh.positions = taken(all.positions, entity.vertices);
  if (!all.normals.empty()) mesh.normals = taken(all.normals, entity.vertices);
  mesh.triangles = taken(all.triangles, entity.triangles);
  for (uvec3& t : mesh.triangles) t -= unsigned(entity.vertices.first);
  return mesh;
}

}  // namespace

Animation::Animation(const Scene& scene) : scene_(scene) {
  if (scene.motion.kind == Motion::Kind::rotate_light) light_ = scene.light;
  if (scene.entities.empty())
    begin({scene.name, {0, scene.mesh.positions.size()}, {0, scene.mesh.triangles.size()}, {0, scene.spheres.size()}});
  for (const Entity& entity : scene.entities) begin(entity);
  if (deforms()) mesh_ = scene.mesh, spheres_ = scene.spheres;
}

void Animation::begin(const Entity& entity) {
  Moving part;
  part.entity = entity;
  if (entity.motion.kind == Motion::Kind::none) part.entity.motion = scene_.motion;
  if (!part.entity.motion.moves_occluder()) return;
  part.rest = part_of(scene_.mesh, entity);
  part.box = bounds(part.rest);
  part.rest_spheres.spheres = taken(scene_.spheres.spheres, entity.spheres);
  if (!part.rest.empty() && !part.rest_spheres.empty())
    part.carrier = SphereCarrier(part.rest, part.rest_spheres, part.entity.motion.carry);
  part.mesh = part.rest, part.spheres = part.rest_spheres;
  moving_.push_back(std::move(part));
}

int Animation::frames() const {
  int frames = scene_.motion.kind == Motion::Kind::none ? 1 : scene_.motion.frames;
  for (const Moving& part : moving_) frames = std::max(frames, part.entity.motion.frames);
  return frames;
}

void Animation::move(Moving& part, int index) {
  const Motion& motion = part.entity.motion;
  const float phase = phase_of(motion, index);
  for (std::size_t i = 0; i < part.mesh.positions.size(); ++i)
    part.mesh.positions[i] = moved(motion, part.box, part.rest.positions[i], phase);
  for (std::size_t i = 0; i < part.mesh.normals.size(); ++i)
    part.mesh.normals[i] = moved_normal(motion, part.box, part.rest.positions[i], part.rest.normals[i], phase);
  if (!part.mesh.empty()) part.carrier.move(part.mesh, part.spheres);
  else
    for (std::size_t i = 0; i < part.spheres.size(); ++i)
      part.spheres.spheres[i].centre = moved(motion, part.box, part.rest_spheres.spheres[i].centre, phase);
  const auto put = [](const auto& from, auto& to, std::size_t first) {
    if (!from.empty()) std::copy(from.begin(), from.end(), to.begin() + std::ptrdiff_t(first));
  };
  put(part.mesh.positions, mesh_.positions, part.entity.vertices.first);
  put(part.mesh.normals, mesh_.normals, part.entity.vertices.first);
  put(part.spheres.spheres, spheres_.spheres, part.entity.spheres.first);
}

ReceiverSpec Animation::receiver_spec(int index) const {
  ReceiverSpec spec = scene_.receiver_spec;
  auto* camera = std::get_if<Camera>(&spec.kind);
  if (!camera || !scene_.motion.moves_camera()) return spec;
  const float by = scene_.motion.amount * phase_of(scene_.motion, index);
  const vec3 away = camera->eye - camera->target;
  camera->eye = camera->target + (scene_.motion.kind == Motion::Kind::orbit ? turn_y(away, by) : std::exp(by) * away);
  return spec;
}

Frame Animation::frame(int index) {
  Changes changed;
  if (scene_.motion.kind == Motion::Kind::rotate_light) {
    changed.light = true;
    turn_light(scene_.light, scene_.motion, index, light_);
  }
  if (deforms()) {
    changed.mesh = changed.spheres = true;
    for (Moving& part : moving_) move(part, index);
  }
  const bool on_plane = std::holds_alternative<PlaneGrid>(scene_.receiver_spec.kind);
  if ((changed.mesh && !on_plane) || scene_.motion.moves_camera()) {
    changed.receivers = true;
    receivers_ = make_receivers(receiver_spec(index), changed.mesh ? mesh_ : scene_.mesh);
  }
  return {double(index),
          changed.mesh ? mesh_ : scene_.mesh,
          changed.spheres ? spheres_ : scene_.spheres,
          changed.light ? light_ : scene_.light,
          changed.receivers ? receivers_ : scene_.receivers,
          changed};
}

}  // namespace penumbra
