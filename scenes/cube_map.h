// Geometry of cube maps. Faces in order +X -X +Y -Y +Z -Z with OpenGL's face axes; texel (row, column), row 0 on
// top; texels are numbered face * n * n + row * n + column everywhere in the project.
#pragma once

#include <cmath>
#include <vector>

#include "scenes/math.h"

namespace penumbra {

template <class T>
struct CubeMap {
  int n = 0;  ///< texels along an edge
  std::vector<T> texels;
  CubeMap() = default;
  explicit CubeMap(int edge, T value = T{}) : n(edge), texels(std::size_t(6) * edge * edge, value) {}
};

/// Direction of face coordinates s (to the right) and t (downward) in [-1, 1]; its longest component is 1.
PENUMBRA_HD inline vec3 cube_direction(int face, float s, float t) {
  switch (face) {
    case 0:
      return {1.0f, -t, -s};
    case 1:
      return {-1.0f, -t, s};
    case 2:
      return {s, 1.0f, t};
    case 3:
      return {s, -1.0f, -t};
    case 4:
      return {s, -t, 1.0f};
    default:
      return {-s, -t, -1.0f};
  }
}

/// Face of a direction and its coordinates there. Ties go to X, then Y. A zero or NaN direction lands somewhere
/// on face 5 without trapping.
PENUMBRA_HD inline int cube_face(vec3 d, float& s, float& t) {
  const float ax = d.x < 0 ? -d.x : d.x, ay = d.y < 0 ? -d.y : d.y, az = d.z < 0 ? -d.z : d.z;
  if (ax >= ay && ax >= az && ax > 0) {
    const float inverse = 1.0f / ax;
    s = (d.x > 0 ? -d.z : d.z) * inverse;
    t = -d.y * inverse;
    return d.x > 0 ? 0 : 1;
  }
  if (ay >= az && ay > 0) {
    const float inverse = 1.0f / ay;
    s = d.x * inverse;
    t = (d.y > 0 ? d.z : -d.z) * inverse;
    return d.y > 0 ? 2 : 3;
  }
  const float inverse = 1.0f / az;
  s = (d.z > 0 ? d.x : -d.x) * inverse;
  t = -d.y * inverse;
  return d.z > 0 ? 4 : 5;
}

/// Row or column of a face coordinate in [-1, 1].
PENUMBRA_HD inline int cube_coordinate(float s, int n) {
  const float at = (s + 1.0f) * (0.5f * float(n));
  return at >= float(n) ? n - 1 : at > 0.0f ? int(at) : 0;  // 0 for NaN, too
}

/// Number of the texel that contains a direction (of any length).
PENUMBRA_HD inline int cube_texel(vec3 d, int n) {
  float s, t;
  const int face = cube_face(d, s, t);
  return (face * n + cube_coordinate(t, n)) * n + cube_coordinate(s, n);
}

/// Coordinate of the centre of column (or row) i.
PENUMBRA_HD inline float cube_centre(int i, int n) {
  return float(2 * i + 1) / float(n) - 1.0f;
}

/// Unit direction of a texel's centre.
PENUMBRA_HD inline vec3 cube_texel_direction(int texel, int n) {
  const int face = texel / (n * n), row = texel / n % n, column = texel % n;
  return glm::normalize(cube_direction(face, cube_centre(column, n), cube_centre(row, n)));
}

/// Solid angle, sr, of the rectangle [s0, s1] x [t0, t1] of a face (any face).
inline double cube_solid_angle(double s0, double s1, double t0, double t1) {
  const auto corner = [](double x, double y) { return std::atan2(x * y, std::sqrt(x * x + y * y + 1.0)); };
  return corner(s1, t1) - corner(s0, t1) - corner(s1, t0) + corner(s0, t0);
}

/// Solid angle of a texel, sr.
inline double cube_texel_solid_angle(int texel, int n) {
  const int row = texel / n % n, column = texel % n;
  const double h = 2.0 / n;
  return cube_solid_angle(column * h - 1.0, (column + 1) * h - 1.0, row * h - 1.0, (row + 1) * h - 1.0);
}

}  // namespace penumbra
