// Scenes under a lamp, and shadows on them whose answer is known.
#pragma once

#include <algorithm>
#include <cmath>

#include "techniques/bases/area_irradiance.h"
#include "tests/support.h"

namespace penumbra::test {

inline constexpr const char* backends[] = {"scalar", "simd"};

inline const AreaLight lamp = make_rectangle({0, 4, 0}, {1, 0, 0}, {0, 0, 1}, vec3(10.0f));

/// A flat rectangle seen from above.
inline Mesh plate(vec2 low, vec2 high, float y) {
  Mesh mesh;
  mesh.positions = {{low.x, y, low.y}, {low.x, y, high.y}, {high.x, y, high.y}, {high.x, y, low.y}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  return mesh;
}

inline Scene lamp_scene(const Mesh& mesh, const Receivers& receivers, const AreaLight& light = lamp) {
  Scene scene;
  scene.name = "test";
  scene.mesh = mesh;
  scene.receivers = receivers;
  scene.receiver_spec.kind = PlaneGrid{};
  scene.light = light;
  return scene;
}

/// Radiance over unshadowed radiance.
inline std::vector<double> visibility(const std::string& name, const std::string& backend,
                                      const std::vector<std::string>& parameters, const Scene& scene) {
  const std::vector<vec3> image = shade(name, backend, parameters, scene);
  const AreaLight& light = *area_light_of(scene.light);
  const LampOutline outline = make_outline(light);
  std::vector<double> result;
  for (std::size_t i = 0; i < image.size(); ++i) {
    const float open = light.radiance.x * form_factor(outline, scene.receivers.position[i], scene.receivers.normal[i]);
    result.push_back(open > 0.0f ? double(image[i].x / open) : 1.0);
  }
  return result;
}

inline std::vector<vec3> row_of_points(float from, float to, int count) {
  std::vector<vec3> points;
  for (int k = 0; k < count; ++k)
    points.emplace_back(from + (to - from) * (float(k) + 0.5f) / float(count), 0.0f, 0.0f);
  return points;
}

/// A half-plane at y = 1 whose edge lies below the middle of the lamp at y = 4: of a receiver at x it covers what of
/// the lamp lies beyond -3 x of its middle.
using Ramp = double (*)(double offset, double size);

/// A square lamp, or any that a square stands for, of full width `size`.
inline double square_ramp(double offset, double size) {
  return std::clamp(0.5 + offset / size, 0.0, 1.0);
}

/// A disc of radius `size`: the segment that a chord at `offset` leaves.
inline double disc_ramp(double offset, double size) {
  const double t = std::clamp(offset / size, -1.0, 1.0);
  return 0.5 + (std::asin(t) + t * std::sqrt(1.0 - t * t)) / pi;
}

inline void expect_ramp(const std::string& name, const std::vector<std::string>& parameters, double tolerance,
                        const AreaLight& light, double size, Ramp ramp = square_ramp) {
  const std::vector<vec3> points = row_of_points(-0.3f, 0.3f, 61);
  const Scene scene = lamp_scene(plate({-1.5f, -1.5f}, {0.0f, 1.5f}, 1.0f), receivers_at(points), light);
  for (const char* backend : backends) {
    const std::vector<double> found = visibility(name, backend, parameters, scene);
    for (std::size_t i = 0; i < points.size(); ++i)
      EXPECT_NEAR(found[i], ramp(3.0 * double(points[i].x), size), tolerance)
          << name << " " << backend << " at x = " << points[i].x;
  }
}

}  // namespace penumbra::test
