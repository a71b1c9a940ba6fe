#include "harness/commands/fit_picture.h"

#include <tbb/parallel_for.h>

#include <cmath>

#include "scenes/ray_scene.h"

namespace penumbra {
namespace {

/// Hues that neighbours in the list do not share (golden ratio).
vec3 colour_of(unsigned sphere) {
  const float hue = std::fmod(0.618034f * float(sphere), 1.0f) * 6.0f;
  const auto channel = [&](float shift) {
    return glm::clamp(std::abs(std::fmod(hue + shift, 6.0f) - 3.0f) - 1.0f, 0.0f, 1.0f);
  };
  return 0.15f + 0.75f * vec3(channel(0.0f), channel(4.0f), channel(2.0f));
}

vec3 shaded(const Hit& hit, vec3 colour, vec3 direction) {
  const float facing = std::abs(glm::dot(glm::normalize(hit.normal), direction));
  return colour * (0.15f + 0.85f * facing * facing);
}

}  // namespace

Image draw_fit(const Mesh& mesh, const SphereSet& set, int size) {
  RayScene surface(mesh), balls;
  balls.build(set);
  Bounds box = bounds(mesh);
  const Bounds more = bounds(set);
  if (!set.empty()) box = {glm::min(box.low, more.low), glm::max(box.high, more.high)};
  const float half = 0.5f * glm::length(box.extent());
  const vec3 forward = glm::normalize(vec3(-0.45f, -0.35f, -0.82f)),
             right = glm::normalize(glm::cross(forward, {0, 1, 0}));
  const vec3 up = glm::cross(right, forward);
  Image image{3 * size, size, std::vector<vec3>(std::size_t(3) * size * size, vec3(1.0f))};
  tbb::parallel_for(0, size, [&](int row) {
    for (int column = 0; column < size; ++column) {
      const float x = (2.0f * (float(column) + 0.5f) / float(size) - 1.0f) * half;
      const float y = (1.0f - 2.0f * (float(row) + 0.5f) / float(size)) * half;
      const vec3 origin = box.centre() + x * right + y * up - 2.0f * half * forward;
      const Hit on_mesh = surface.intersect(origin, forward), on_ball = balls.intersect(origin, forward);
      vec3* pixel = &image.pixels[std::size_t(row) * image.width + column];
      if (on_mesh) pixel[0] = shaded(on_mesh, vec3(0.6f), forward);
      if (on_ball) pixel[size] = shaded(on_ball, colour_of(on_ball.triangle), forward);
      if (on_mesh || on_ball) pixel[2 * size] = on_mesh.distance <= on_ball.distance ? pixel[0] : pixel[size];
    }
  });
  return image;
}

}  // namespace penumbra
