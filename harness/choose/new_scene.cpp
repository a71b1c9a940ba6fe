#include "harness/choose/new_scene.h"

#include <toml++/toml.h>

#include <charconv>
#include <cmath>
#include <filesystem>
#include <optional>
#include <sstream>

#include "scenes/assets.h"
#include "scenes/error.h"
#include "scenes/light.h"
#include "scenes/names.h"
#include "scenes/shapes.h"
#include "scenes/storage/atomic_write.h"

namespace penumbra {
namespace fs = std::filesystem;
namespace {

/// Numbers between the given separators, in order; absent if the text does not read so to its end.
std::optional<std::vector<double>> numbers_between(const std::string& text, const std::string& separators) {
  std::vector<double> numbers;
  const char *at = text.data(), *last = at + text.size();
  for (std::size_t k = 0;; ++k) {
    double number = 0.0;
    const auto [end, fault] = std::from_chars(at, last, number);
    if (fault != std::errc() || !std::isfinite(number)) return {};
    numbers.push_back(number);
    at = end;
    if (k == separators.size()) break;
    if (at == last || *at != separators[k]) return {};
    ++at;
  }
  return at == last ? std::optional(numbers) : std::nullopt;
}

/// As a TOML string.
std::string quoted(const std::string& text) {
  std::ostringstream out;
  out << toml::value<std::string>(text);
  return out.str();
}

std::string stem_of(const std::string& name) {
  return fs::path(name).stem().string();
}

/// The name itself if it is built in or an asset, else the absolute path of the file.
std::string place_of(const std::string& name, const std::string& kind, bool built_in, const char* option,
                     const char* others) {
  if (built_in || !asset_file(name, kind).empty()) return name;
  if (fs::is_regular_file(name)) return fs::absolute(name).lexically_normal().string();
  throw Error("{}{}: no such file, and no such name; names are {}, {}", option, name, asset_names(kind), others);
}

std::string vector_text(dvec3 v) {
  return fmt::format("[{:.6g}, {:.6g}, {:.6g}]", v.x, v.y, v.z);
}

std::string lamp_text(const Lamp& lamp, double mesh_height) {
  const dvec3 centre(lamp.x, lamp.y, lamp.z), towards = dvec3(0.0, 0.5 * mesh_height, 0.0) - centre;
  if (glm::length(towards) == 0.0) throw Error("--lamp: it lies in the middle of the mesh; move it out");
  const dvec3 down = glm::normalize(towards);
  if (lamp.radius > 0.0)
    return fmt::format("area = {{ centre = {}, normal = {}, radius = {:.6g}, radiance = [1.0, 1.0, 1.0] }}",
                       vector_text(centre), vector_text(down), lamp.radius);
  const dvec3 across = std::abs(down.y) > 0.999 ? dvec3(1, 0, 0) : glm::normalize(glm::cross(down, dvec3(0, 1, 0)));
  return fmt::format("area = {{ centre = {}, edge_u = {}, edge_v = {}, radiance = [1.0, 1.0, 1.0] }}",
                     vector_text(centre), vector_text(lamp.width * across),
                     vector_text(lamp.height * glm::cross(down, across)));
}

/// The light's line in the file, and its name.
std::pair<std::string, std::string> light_of(const SceneRequest& request, double mesh_height) {
  if (!request.light.empty() && !request.lamp.empty()) throw Error("--light and --lamp: one light is allowed");
  if (!request.lamp.empty()) return {lamp_text(parse_lamp(request.lamp), mesh_height), "lamp"};
  const std::string name = request.light.empty() ? "sun-sky" : request.light;
  Environment unused;
  const std::string place =
      place_of(name, "environment", make_environment(name, unused), "--light ", environment_names);
  return {"environment = " + quoted(place), stem_of(name)};
}

bool has_area(const Mesh& mesh) {
  return std::any_of(mesh.triangles.begin(), mesh.triangles.end(), [&](const uvec3& t) {
    const dvec3 a(mesh.positions[t.x]), b(mesh.positions[t.y]), c(mesh.positions[t.z]);
    return glm::length(glm::cross(b - a, c - a)) > 1e-12 * glm::dot(b - a, b - a);
  });
}

std::string scene_name(const std::string& mesh, const std::string& light) {
  const std::string name = file_name(stem_of(mesh) + "-" + light);
  return name_fault(name).empty() ? name : "mesh-and-light";
}

}  // namespace

Lamp parse_lamp(const std::string& text) {
  Lamp lamp;
  if (const auto n = numbers_between(text, "x@,,")) {
    lamp = {(*n)[0], (*n)[1], 0.0, (*n)[2], (*n)[3], (*n)[4]};
    if (lamp.width > 0.0 && lamp.height > 0.0) return lamp;
  } else if (const auto disc = numbers_between(text, "@,,")) {
    lamp = {0.0, 0.0, (*disc)[0], (*disc)[1], (*disc)[2], (*disc)[3]};
    if (lamp.radius > 0.0) return lamp;
  }
  throw Error("--lamp {}: allowed is a rectangle WxH@x,y,z or a disc RADIUS@x,y,z in metres, of a size above 0", text);
}

bool names_scene(const std::string& subject) {
  const std::vector<std::string> shipped = shipped_names("library");
  return subject.ends_with(".toml") || std::find(shipped.begin(), shipped.end(), subject) != shipped.end();
}

std::string write_scene(const SceneRequest& request, const std::string& folder) {
  Mesh shape;
  const std::string mesh_place = place_of(request.mesh, "mesh", make_shape(request.mesh, shape), "",
                                          (std::string(shape_names) + "; scenes: see `penumbra list`").c_str());
  const Mesh mesh = mesh_by_name(request.mesh);
  if (!has_area(mesh)) throw Error("{}: none of its {} triangles has an area", request.mesh, mesh.triangles.size());
  vec3 size = bounds(mesh).extent();
  if (request.up == "z") size = {size.x, size.z, size.y};
  double scale = 1.0;
  if (request.height > 0.0) {
    if (!(size.y > 0.0f)) throw Error("--height: the mesh {} is flat and cannot be scaled to one", request.mesh);
    scale = request.height / double(size.y);
  }
  const double height = scale * double(size.y);
  const double half_extent = 0.5 * scale * double(std::max(size.x, size.z)) + 0.8 * height;
  const auto [light, light_name] = light_of(request, height);
  std::string text = fmt::format("name = {}\n\n[occluder]\nmesh = {}\n", quoted(scene_name(request.mesh, light_name)),
                                 quoted(mesh_place));
  if (request.up == "z") text += "up = \"z\"\n";
  text += request.height > 0.0 ? fmt::format("fit = {{ height = {:.6g}, on_ground = true }}\n", request.height)
                               : "fit = { on_ground = true }\n";
  text += "spheres = 64\n";
  text += fmt::format("\n[receivers]\nplane = {{ half_extent = {:.4g}, resolution = {} }}\n\n[light]\n{}\n",
                      half_extent, request.resolution, light);
  if (request.moving) text += "\n[motion]\nkind = \"twist\"\namount = 0.5\nperiod = 16.0\nframes = 16\n";
  std::string path = folder + "/scene.toml";
  write_atomically(path, text);
  return path;
}

}  // namespace penumbra
