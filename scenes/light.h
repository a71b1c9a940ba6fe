// The light of a scene: an environment, a rectangular or disc-shaped area light, or several of these.
#pragma once

#include <span>
#include <variant>

#include "scenes/environment.h"

namespace penumbra {

/// From the unit square to the disc of radius 1/2 about the origin; equal areas stay equal (Shirley & Chiu 1997).
vec2 concentric_disc(float u, float v);

/// Emits `radiance` (W m^-2 sr^-1) evenly to the side that its normal points to.
struct AreaLight {
  enum class Shape { rectangle, disc };
  Shape shape = Shape::rectangle;
  vec3 centre{0.0f};
  vec3 edge_u{1, 0, 0}, edge_v{0, 0, 1};  ///< rectangle: full edges; disc: diameters
  vec3 normal{0, -1, 0};                  ///< unit; rectangle: along edge_u x edge_v
  vec3 radiance{1.0f};

  double area() const;  ///< m^2
  /// Point of the light for (u, v) in [0, 1]^2; equal areas there are equal areas of the light (disc: concentric_disc).
  vec3 point(float u, float v) const;
};

/// Lamps with edges or a normal of any length. Parallel edges and a radius of 0 make one without area or light.
AreaLight make_rectangle(vec3 centre, vec3 edge_u, vec3 edge_v, vec3 radiance);
AreaLight make_disc(vec3 centre, vec3 normal, float radius, vec3 radiance);

struct Light;

/// Lights that shine together.
struct Lights {
  std::vector<Light> each;  ///< none of them several
};

struct Light : std::variant<Environment, AreaLight, Lights> {
  using variant::variant;
};

inline const Environment* environment_of(const Light& light) {
  return std::get_if<Environment>(&light);
}
inline const AreaLight* area_light_of(const Light& light) {
  return std::get_if<AreaLight>(&light);
}

/// The lights that a light is made of: itself, or each of several.
inline std::span<const Light> each_of(const Light& light) {
  const Lights* several = std::get_if<Lights>(&light);
  return several ? std::span<const Light>(several->each) : std::span<const Light>(&light, 1);
}

}  // namespace penumbra
