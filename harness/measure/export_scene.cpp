#include "harness/measure/export_scene.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "harness/measure/reference.h"
#include "scenes/environment_image.h"
#include "scenes/float_map.h"
#include "scenes/storage/atomic_write.h"

namespace penumbra {
namespace {

using nlohmann::json;

template <class Vector>
json numbers(const Vector& v) {
  return json::array({v.x, v.y, v.z});
}

/// Binary PLY of vertices with float properties, and of triangles if there are any.
void write_ply(const std::string& path, const std::vector<std::string>& properties, const std::vector<float>& values,
               const std::vector<uvec3>& triangles) {
  write_atomically(path, [&](std::ostream& out) {
    out << "ply\nformat binary_little_endian 1.0\nelement vertex " << values.size() / properties.size() << "\n";
    for (const std::string& property : properties) out << "property float " << property << "\n";
    if (!triangles.empty()) out << "element face " << triangles.size() << "\nproperty list uchar uint vertex_indices\n";
    out << "end_header\n";
    out.write(reinterpret_cast<const char*>(values.data()), std::streamsize(values.size() * sizeof(float)));
    for (const uvec3& t : triangles) {
      out.put(3);
      out.write(reinterpret_cast<const char*>(&t), sizeof t);
    }
  });
}

json export_mesh(const Mesh& mesh, const std::string& directory) {
  if (mesh.empty()) return nullptr;
  const std::vector<vec3> normals = vertex_normals(mesh);
  std::vector<float> values;
  for (std::size_t i = 0; i < mesh.positions.size(); ++i)
    for (const vec3 v : {mesh.positions[i], normals[i]}) values.insert(values.end(), {v.x, v.y, v.z});
  write_ply(directory + "/mesh.ply", {"x", "y", "z", "nx", "ny", "nz"}, values, mesh.triangles);
  return {{"file", "mesh.ply"},
          {"vertices", mesh.positions.size()},
          {"triangles", mesh.triangles.size()},
          {"meaning", "blocks light from both sides; counter-clockwise seen from outside; nx ny nz are what shades"}};
}

json export_spheres(const SphereSet& spheres, const std::string& directory) {
  if (spheres.empty()) return nullptr;
  save_spheres(directory + "/spheres.json", spheres);
  return {{"file", "spheres.json"},
          {"count", spheres.size()},
          {"meaning", "[x, y, z, radius] each, in place of the mesh for techniques that want spheres"}};
}

json kind_of(const ReceiverSpec& spec) {
  if (const auto* plane = std::get_if<PlaneGrid>(&spec.kind))
    return {{"kind", "plane"}, {"centre", {plane->x, plane->y, plane->z}}, {"half_extent", plane->half_extent}};
  if (const auto* camera = std::get_if<Camera>(&spec.kind))
    return {{"kind", "camera"},
            {"eye", numbers(camera->eye)},
            {"target", numbers(camera->target)},
            {"up", {0, 1, 0}},
            {"vertical_fov_degrees", camera->vertical_fov},
            {"ground", camera->has_ground ? json(camera->ground) : json(nullptr)}};
  return {{"kind", "vertices"}};
}

json mirror_json(const Mirror& mirror) {
  if (const auto* ball = std::get_if<Sphere>(&mirror.shape))
    return {{"kind", "sphere"}, {"centre", numbers(ball->centre)}, {"radius", ball->radius}, {"shadow", mirror.shadow}};
  const auto& plane = std::get<MirrorPlane>(mirror.shape);
  return {{"kind", "plane"},
          {"centre", numbers(plane.centre)},
          {"edge_u", numbers(plane.edge_u)},
          {"edge_v", numbers(plane.edge_v)},
          {"shadow", mirror.shadow}};
}

json export_receivers(const ReceiverSpec& spec, const Receivers& r, const std::string& directory) {
  ChannelImage image{r.width, r.height, {}, {}, {}};
  for (const char* layer : {"P", "N"})
    for (const char* axis : {".X", ".Y", ".Z"}) image.channels.push_back(std::string(layer) + axis);
  for (const char* name : {"albedo.R", "albedo.G", "albedo.B", "ray.X", "ray.Y", "ray.Z"})
    image.channels.emplace_back(name);
  for (int i = 0; i < r.size(); ++i)
    for (const vec3 v : {r.position[i], r.normal[i], r.albedo[i], r.ray_origin(i)})
      image.values.insert(image.values.end(), {v.x, v.y, v.z});
  save_channels(directory + "/receivers.exr", image);
  write_ply(directory + "/receivers.ply",
            {"x", "y", "z", "nx", "ny", "nz", "albedo_r", "albedo_g", "albedo_b", "ray_x", "ray_y", "ray_z"},
            image.values, {});
  const std::vector<bool> valid = valid_receivers(r);
  json out = kind_of(spec);
  out["files"] = {"receivers.exr", "receivers.ply"};
  out["order"] = "row-major, row 0 on top: point number y * width + x is pixel (x, y)";
  out["valid"] = std::count(valid.begin(), valid.end(), true);
  out["invalid"] = "where the normal is 0 nothing is seen: the pixel is 0, and is not scored";
  out["position"] = "channels P, properties x y z";
  out["normal"] = "channels N, properties nx ny nz: unit, on the side that is shaded";
  out["albedo"] = "channels albedo, properties albedo_r albedo_g albedo_b: diffuse, linear";
  out["ray"] =
      "channels ray, properties ray_x ray_y ray_z: where shadow rays start, beside what they would hit by "
      "rounding; they need no other offset";
  return out;
}

json export_environment(const Environment& environment, const std::string& directory) {
  const LatLongImage light = as_lat_long(environment);
  save_exr(directory + "/light.exr", light.image);
  save_pfm(directory + "/light.pfm", light.image);
  return {{"kind", "environment"},
          {"files", {"light.exr", "light.pfm"}},
          {"width", light.image.width},
          {"height", light.image.height},
          {"left_edge", light.left_edge},
          {"rotation", environment.rotation},
          {"exact", light.exact},
          {"meaning",
           "radiance, W m^-2 sr^-1, constant in a texel; the rotation is in the image. Texel (x, y), row 0 on top: "
           "longitude = left_edge - 2 pi (x + 1/2) / width, latitude = pi/2 - pi (y + 1/2) / height, direction to the "
           "light = (sin lon cos lat, sin lat, cos lon cos lat)"}};
}

json lamp_json(const AreaLight& lamp) {
  const bool disc = lamp.shape == AreaLight::Shape::disc;
  return {{"kind", disc ? "disc" : "rectangle"},
          {"centre", numbers(lamp.centre)},
          {"edge_u", numbers(lamp.edge_u)},
          {"edge_v", numbers(lamp.edge_v)},
          {"normal", numbers(lamp.normal)},
          {"radiance", numbers(lamp.radiance)},
          {"area", lamp.area()},
          {"meaning", std::string("radiance, W m^-2 sr^-1, evenly to the side of `normal` alone; ") +
                          (disc ? "edges are diameters" : "edges are whole, about the centre") + "; area in m^2"}};
}

json light_json(const Light& light, const std::string& directory) {
  if (const Environment* environment = environment_of(light)) return export_environment(*environment, directory);
  if (const AreaLight* lamp = area_light_of(light)) return lamp_json(*lamp);
  json several{{"kind", "several"}, {"meaning", "light adds up"}};
  for (const Light& one : each_of(light)) several["lights"].push_back(light_json(one, directory));
  return several;
}

}  // namespace

void export_scene(const Animation& animation, const Frame& frame, const std::string& directory) {
  make_folder(directory);
  const Scene& scene = animation.scene();
  const Receivers& r = frame.receivers;
  json out;
  out["scene"] = scene.name;
  out["frame"] = int(frame.time);
  out["frames"] = animation.frames();
  out["units"] = "metres; radiance in W m^-2 sr^-1, linear RGB with the primaries of Rec. 709";
  out["axes"] = "right-handed, y up";
  out["origin"] = numbers(scene.origin);
  out["origin_means"] = "add it to coordinates of this folder for those of the scene's file";
  out["formula"] = "B = albedo / pi * integral over all directions w of L(w) V(w) max(0, dot(normal, w)) dw";
  out["image"] = {{"width", r.width}, {"height", r.height}, {"channels", "R, G, B: B of the formula, not exposed"}};
  out["receivers"] = export_receivers(animation.receiver_spec(int(frame.time)), r, directory);
  for (const Mirror& mirror : scene.receiver_spec.mirrors) out["mirrors"].push_back(mirror_json(mirror));
  out["mesh"] = export_mesh(frame.mesh, directory);
  out["spheres"] = export_spheres(frame.spheres, directory);
  out["light"] = light_json(frame.light, directory);
  write_atomically(directory + "/scene.json", out.dump(1) + "\n");
}

}  // namespace penumbra
