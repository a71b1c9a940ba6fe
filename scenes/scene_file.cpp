#include "scenes/scene_file.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "scenes/assets.h"
#include "scenes/entities_file.h"
#include "scenes/log.h"
#include "scenes/names.h"
#include "scenes/receivers_file.h"
#include "scenes/scene_keys.h"
#include "scenes/shapes.h"

namespace penumbra {
namespace {

Layout read_layout(TomlReader& at) {
  const auto mapping = at.text("mapping");
  if (!mapping) return Layout::automatic;
  const std::pair<const char*, Layout> names[] = {{"lat-long", Layout::lat_long},
                                                  {"cross", Layout::vertical_cross},
                                                  {"strip", Layout::horizontal_strip},
                                                  {"angular", Layout::angular}};
  for (const auto& [name, layout] : names)
    if (*mapping == name) return layout;
  at.fail("mapping", "is '" + *mapping + "'; allowed are lat-long, cross, strip, angular");
}

AreaLight read_area_light(TomlReader at, dvec3 origin) {
  const vec3 centre(at.required("centre", read_place(at, "centre"), "[x, y, z]") - origin);
  const auto radiance = at.vector("radiance").value_or(vec3(1.0f));
  if (glm::any(glm::lessThan(radiance, vec3(0.0f)))) at.fail("radiance", "must not be negative");
  AreaLight light;
  if (at.has("radius")) {
    const double radius = *at.number("radius", 0.0, huge);
    const vec3 normal = at.required("normal", read_direction(at, "normal"), "the side it shines to");
    light = make_disc(centre, normal, float(radius), radiance);
  } else {
    const vec3 u = at.required("edge_u", read_place(at, "edge_u"), "a rectangle's edge (a disc has normal and radius)");
    const vec3 v = at.required("edge_v", read_place(at, "edge_v"), "a rectangle's edge");
    light = make_rectangle(centre, u, v, radiance);
  }
  at.finish();
  return light;
}

Environment read_environment(TomlReader& at) {
  const std::string name = *at.text("environment");
  const Layout layout = read_layout(at);
  const auto layer = at.text("layer");
  if (layer && layer->empty()) at.fail("layer", "must name a layer or a part of an OpenEXR image");
  Environment environment;
  if (!make_environment(name, environment)) {
    const std::string file = resolve(at, "environment", name, "environment", environment_names);
    environment = at_key(at, "environment", [&] { return load_environment(file, layout, layer.value_or("")); });
  } else if (layer) {
    at.fail("layer", "chooses a layer of an image file; '" + name + "' is none");
  }
  environment.rotation = at.number("rotation", -100.0, 100.0).value_or(0.0);
  return environment;
}

/// An environment, lamps, or both together.
Light read_light(TomlReader at, dvec3 origin) {
  Lights lights;
  if (at.has("environment")) lights.each.emplace_back(read_environment(at));
  const toml::node* lamps = at.node("area");
  if (lamps && lamps->is_array())
    for (TomlReader& lamp : at.tables("area")) lights.each.emplace_back(read_area_light(lamp, origin));
  else if (lamps) lights.each.emplace_back(read_area_light(*at.table("area"), origin));
  at.finish();
  if (lights.each.empty()) at.fail("environment", "is missing, and so is 'area': a scene needs a light");
  if (lights.each.size() > 1) return lights;
  return std::move(lights.each.front());
}

}  // namespace

std::string read_name(TomlReader& file) {
  if (const auto name = file.text("name")) {
    if (const std::string fault = name_fault(*name); !fault.empty()) file.fail("name", fault);
    return *name;
  }
  std::string stem = std::filesystem::path(file.file()).stem().string();
  if (const std::string fault = name_fault(stem); !fault.empty())
    throw Error("{}: key 'name' is missing, and the file's own name {}", file.where(), fault);
  return stem;
}

Scene load_scene(const std::string& name_or_path, const SphereChoice& choice, const FitProgress& progress) {
  TomlReader file = TomlReader::open(shipped_file(name_or_path, "library"));
  Scene scene;
  scene.name = read_name(file);
  const auto section = [&](const char* key) { return file.required(key, file.table(key), "a table"); };
  EntityList things = read_entities(file, choice, progress);
  scene.receiver_spec = read_receivers(section("receivers"), things.mesh, scene.origin);
  read_motions_of_entities(things, scene.origin);
  scene.entities = std::move(things.entities), scene.objective = things.objective.name();
  scene.light = read_light(section("light"), scene.origin);
  if (auto motion = file.table("motion")) scene.motion = read_motion(*motion, scene.origin);
  scene.receiver_spec.mirrors = read_mirrors(file, scene.origin);
  if (scene.motion.moves_camera() && !std::holds_alternative<Camera>(scene.receiver_spec.kind))
    file.fail("motion", "moves the camera, but the receivers are none");
  const auto moves_alone = [](const Entity& e) { return e.motion.kind != Motion::Kind::none; };
  if (scene.motion.moves_occluder() && std::all_of(scene.entities.begin(), scene.entities.end(), moves_alone))
    file.fail("motion", "moves nothing: every entity has a motion of its own");
  check_mirrors(file, scene, !things.spheres.empty() || !scene.objective.empty());
  file.finish();
  scene.mesh = narrowed(things.mesh, scene.origin);
  if (!scene.mesh.empty()) validate(scene.mesh, scene.name);
  if (const std::size_t coarse = count_coarse(scene.mesh))
    warn(
        "{}: {} of {} triangles lie so far from the receivers that single precision rounds their corners by more than "
        "a thousandth of their size",
        scene.name, coarse, scene.mesh.triangles.size());
  add_mirrors(scene.mesh, scene.receiver_spec.mirrors);
  scene.spheres = narrowed(things.spheres, scene.origin);
  scene.receivers = make_receivers(scene.receiver_spec, scene.mesh);
  return scene;
}

}  // namespace penumbra
