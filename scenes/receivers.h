// The points that are shaded.
#pragma once

#include <variant>
#include <vector>

#include "scenes/mirror.h"

namespace penumbra {

class RayScene;

/// width x height points in row order. A zero normal marks a pixel that shows nothing: its radiance is 0.
struct Receivers {
  int width = 0, height = 0;
  std::vector<vec3> position, normal, albedo;
  std::vector<vec3> origin;               ///< where rays from the point start (scenes/ray_origins.h)
  std::vector<std::uint8_t> touches;      ///< 1 where the point lies on a triangle of the mesh, be it its own or not
  std::vector<float> view_depth;          ///< length of the path from the camera, m; infinity where nothing is seen
  std::vector<std::uint8_t> on_occluder;  ///< 1 where the point lies on the mesh: its own spheres are skipped there

  int size() const { return width * height; }
  bool valid(int i) const { return normal[i] != vec3(0.0f); }
  /// Where rays from point i start: at the point itself if no origins are given.
  vec3 ray_origin(int i) const { return origin.empty() ? position[i] : origin[i]; }
  /// `touches`, or `on_occluder` if that is not given: where depths of the mesh need a bias.
  const std::vector<std::uint8_t>& in_contact() const { return touches.empty() ? on_occluder : touches; }
};

struct PlaneGrid {
  float half_extent = 1.0f;
  int resolution = 128;
  float y = 0.0f;
  float x = 0.0f, z = 0.0f;  ///< of its centre
};
struct MeshVertices {};
struct Camera {
  vec3 eye{0, 1, 3}, target{0.0f};
  float vertical_fov = 45.0f;  ///< degrees
  int width = 512, height = 512;
  bool has_ground = true;
  float ground = 0.0f;  ///< height of a horizontal plane that receives; nothing below it is seen
};

struct ReceiverSpec {
  std::variant<PlaneGrid, MeshVertices, Camera> kind;
  vec3 albedo{1.0f};
  std::vector<Mirror> mirrors = {};  ///< that a camera sees; those that block light end the mesh (add_mirrors)
};

/// Fills origin and touches; `side` holds unit geometric normals on the side that is shaded, `rays` are of the mesh.
/// For receivers that were not made by make_receivers.
void place_ray_origins(Receivers& r, const std::vector<vec3>& side, const Mesh& mesh, const RayScene& rays);

/// The receivers that `which` lists, as width x height; view depths and all else come along.
Receivers subset(const Receivers& all, const std::vector<std::size_t>& which, int width, int height);

/// Positions receivers and their rays' origins; camera pixels are found by Embree primary rays through pixel centres. A
/// pixel that shows a mirror has its receiver where the reflected ray first meets something; behind a second mirror
/// nothing is seen.
/// Receivers on the mesh are shaded with its normals, and on the side that the camera sees or the triangles face.
Receivers make_receivers(const ReceiverSpec& spec, const Mesh& mesh);

}  // namespace penumbra
