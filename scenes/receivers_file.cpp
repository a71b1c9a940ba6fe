#include "scenes/receivers_file.h"

#include <algorithm>

#include "scenes/scene_keys.h"

namespace penumbra {
namespace {

PlaneGrid read_plane(TomlReader in, dvec3& origin) {
  PlaneGrid plane;
  const double half_extent = in.required("half_extent", in.number("half_extent", tiny, huge), "metres");
  plane.half_extent = float(half_extent);
  plane.resolution = in.required("resolution", in.integer("resolution", 1, 4096), "receivers along an edge");
  if (in.has("centre") && in.has("y")) in.fail("y", "is part of the centre");
  const dvec3 centre = read_place(in, "centre").value_or(dvec3(0.0, in.number("y", -huge, huge).value_or(0.0), 0.0));
  origin = local_origin(centre, half_extent);
  const vec3 local(centre - origin);
  plane.x = local.x, plane.y = local.y, plane.z = local.z;
  in.finish();
  return plane;
}

Camera read_camera(TomlReader in, dvec3& origin) {
  Camera camera;
  const dvec3 eye = in.required("eye", read_place(in, "eye"), "[x, y, z]");
  const dvec3 target = in.required("target", read_place(in, "target"), "[x, y, z]");
  if (eye == target) in.fail("target", "is the eye itself");
  if (const double distance = glm::distance(eye, target); !(distance >= tiny && distance <= huge))
    in.fail("target", fmt::format("is {} m from the eye; allowed is [{}, {}]", distance, tiny, huge));
  origin = local_origin(target, glm::distance(eye, target));
  camera.eye = vec3(eye - origin);
  camera.target = vec3(target - origin);
  camera.vertical_fov = float(in.number("vertical_fov", 1.0, 170.0).value_or(45.0));
  camera.width = in.required("width", in.integer("width", 1, 8192), "pixels");
  camera.height = in.required("height", in.integer("height", 1, 8192), "pixels");
  const toml::node* ground = in.node("ground");
  if (ground && ground->is_boolean()) camera.has_ground = *in.boolean("ground");
  else camera.ground = float(in.number("ground", -huge, huge).value_or(0.0) - origin.y);
  in.finish();
  return camera;
}

/// The origin of a scene whose receivers are vertices: the median, which a few parts far away do not move.
dvec3 origin_of(const ImportedMesh& mesh) {
  dvec3 middle, spread;
  std::vector<double> values(mesh.positions.size());
  const auto median = [&](int c, const auto& value) {
    for (std::size_t i = 0; i < values.size(); ++i) values[i] = value(mesh.positions[i][c]);
    const auto at = values.begin() + std::ptrdiff_t(values.size() / 2);
    std::nth_element(values.begin(), at, values.end());
    return *at;
  };
  for (int c = 0; c < 3; ++c) {
    middle[c] = median(c, [](double x) { return x; });
    spread[c] = median(c, [&](double x) { return std::abs(x - middle[c]); });
  }
  return local_origin(middle, 2.0 * std::max({spread.x, spread.y, spread.z}));
}

}  // namespace

ReceiverSpec read_receivers(TomlReader at, const ImportedMesh& mesh, dvec3& origin) {
  ReceiverSpec spec;
  const std::string kind = exactly_one(at, {"plane", "vertices", "camera"});
  if (kind == "plane") {
    spec.kind = read_plane(*at.table("plane"), origin);
  } else if (kind == "camera") {
    spec.kind = read_camera(*at.table("camera"), origin);
  } else {
    if (!*at.boolean("vertices")) at.fail("vertices", "must be true, or absent");
    if (mesh.triangles.empty()) at.fail("vertices", "asks for vertices, but the occluder has no mesh");
    spec.kind = MeshVertices{};
    origin = origin_of(mesh);
  }
  if (const auto albedo = at.vector("albedo")) {
    if (glm::any(glm::lessThan(*albedo, vec3(0.0f))) || glm::any(glm::greaterThan(*albedo, vec3(1.0f))))
      at.fail("albedo", "must lie in [0, 1]");
    spec.albedo = *albedo;
  }
  at.finish();
  return spec;
}

std::vector<Mirror> read_mirrors(TomlReader& file, dvec3 origin) {
  std::vector<Mirror> mirrors;
  for (TomlReader& at : file.tables("mirror")) {
    Mirror mirror;
    if (exactly_one(at, {"sphere", "plane"}) == "sphere") {
      TomlReader in = *at.table("sphere");
      const vec3 centre(in.required("centre", read_place(in, "centre"), "[x, y, z]") - origin);
      mirror.shape = Sphere{centre, float(in.required("radius", in.number("radius", tiny, huge), "metres"))};
      in.finish();
    } else {
      TomlReader in = *at.table("plane");
      MirrorPlane plane;
      plane.centre = vec3(in.required("centre", read_place(in, "centre"), "[x, y, z]") - origin);
      plane.edge_u = in.required("edge_u", read_place(in, "edge_u"), "an edge of the parallelogram");
      plane.edge_v = in.required("edge_v", read_place(in, "edge_v"), "the edge beside it");
      const dvec3 u = plane.edge_u, v = plane.edge_v;
      if (!(glm::length(glm::cross(u, v)) > 1e-6 * glm::length(u) * glm::length(v)))
        in.fail("edge_v", "is parallel to edge_u: the mirror has no area");
      mirror.shape = plane;
      in.finish();
    }
    mirror.shadow = at.boolean("shadow").value_or(true);
    at.finish();
    mirrors.push_back(mirror);
  }
  return mirrors;
}

void check_mirrors(TomlReader& file, const Scene& scene, bool has_spheres) {
  const ReceiverSpec& spec = scene.receiver_spec;
  if (spec.mirrors.empty()) return;
  if (!std::holds_alternative<Camera>(spec.kind))
    file.fail("mirror", "is seen by a camera alone; the receivers are none");
  const bool shadow = std::any_of(spec.mirrors.begin(), spec.mirrors.end(), [](const Mirror& m) { return m.shadow; });
  if (!shadow) return;
  if (has_spheres)
    file.fail("mirror",
              "blocks light, and the occluder's spheres do not stand for it: give it `shadow = false`, or leave "
              "`spheres` out");
}

}  // namespace penumbra
