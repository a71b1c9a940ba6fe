#include "scenes/scene_file.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "scenes/assets.h"
#include "scenes/log.h"
#include "scenes/names.h"
#include "scenes/receivers_file.h"
#include "scenes/scene_keys.h"
#include "scenes/shapes.h"

namespace penumbra {
namespace {

/// Asset name or path relative to the scene file; the key's place is put before whatever goes wrong.
std::string resolve(const TomlReader& at, const std::string& key, const std::string& name, const std::string& kind,
                    const char* built_in) {
  try {
    if (std::string file = asset_file(name, kind); !file.empty()) return file;
  } catch (const Error& e) {
    throw Error("{}: key '{}': {}", at.where(key), at.name(key), e.what());
  }
  const auto path = std::filesystem::path(at.file()).parent_path() / name;
  if (std::filesystem::exists(path)) return path.string();
  at.fail(key, fmt::format("is '{}': no such asset or file; allowed are the names {} and {}, or a path relative to "
                           "the scene file",
                           name, asset_names(kind), built_in));
}

template <class Load>
auto at_key(const TomlReader& at, const std::string& key, Load load) {
  try {
    return load();
  } catch (const Error& e) {
    throw Error("{}: key '{}': {}", at.where(key), at.name(key), e.what());
  }
}

Objective read_objective(TomlReader& at) {
  const auto name = at.text("objective");
  if (!name) return FitRequest().objective;
  return at_key(at, "objective", [&] { return parse_objective(*name); });
}

/// What blocks light, in the scene's coordinates and in double: it is narrowed once the receivers say where.
struct Occluder {
  ImportedMesh mesh;
  SphereList spheres;
};

/// A list [[x, y, z, radius], ...].
SphereList listed_spheres(TomlReader& at, const toml::array& list) {
  SphereList spheres;
  for (const toml::node& item : list) {
    const toml::array* four = item.as_array();
    glm::dvec4 v(0.0);
    bool good = four && four->size() == 4;
    for (int k = 0; good && k < 4; ++k) {
      good = four->get(std::size_t(k))->is_number();
      if (good) v[k] = *four->get(std::size_t(k))->value<double>();
      good = good && std::abs(v[k]) <= huge;
    }
    if (!good || v.w < 0)
      at.fail("spheres", fmt::format("[{}] must be four finite numbers [x, y, z, radius >= 0]", spheres.size()));
    spheres.push_back(v);
  }
  return spheres;
}

/// In the mesh's coordinates. A fit by count keeps the name of its objective in `objective`; spheres from a list or a
/// file leave it empty.
SphereList spheres_of(TomlReader& at, const ImportedMesh& imported, const SphereChoice& choice, std::string& objective,
                      const FitProgress& progress) {
  const toml::node* node = at.node("spheres");
  const bool fitted = choice.count || (node && node->is_integer());
  if (!fitted && at.has("objective")) at.fail("objective", "is for spheres given by count");
  if (!fitted && choice.objective)
    at.fail("spheres", "is no count, so the objective that the suite asks for means nothing");
  const Objective own = read_objective(at);
  if (fitted) {
    FitRequest request;
    request.spheres = choice.count ? *choice.count : *at.integer("spheres", 1, 4096);
    request.objective = choice.objective.value_or(own);
    objective = to_string(request.objective);
    if (imported.triangles.empty()) at.fail("spheres", "asks for a fit, but there is no mesh");
    if (!choice.fitted) return {};
    const Mesh mesh = narrowed(imported);
    if (choice.only_cached) {
      const auto cached = fit_in_cache(mesh, request);
      return cached ? widened(*cached, mesh.origin) : SphereList();
    }
    return at_key(at, "spheres",
                  [&] { return widened(cached_fit(mesh, request, *at.text("mesh"), progress), mesh.origin); });
  }
  if (!node) return {};
  if (node->is_string()) {
    const auto path = std::filesystem::path(at.file()).parent_path() / *at.text("spheres");
    return at_key(at, "spheres", [&] { return read_spheres(path.string()); });
  }
  const toml::array* list = node->as_array();
  if (!list) at.fail("spheres", "must be a count, a file name or a list of [x, y, z, radius]");
  return listed_spheres(at, *list);
}

/// From z up to y up: a quarter turn about x, so that winding and handedness stay.
dvec3 turned_upright(dvec3 p) {
  return {p.x, p.z, -p.y};
}

bool read_z_up(TomlReader& at) {
  const std::string up = at.text("up").value_or("y");
  if (up != "y" && up != "z") at.fail("up", "is '" + up + "'; allowed are y, z");
  return up == "z";
}

Occluder read_occluder(TomlReader at, const SphereChoice& choice, std::string& objective, const FitProgress& progress) {
  Occluder occluder;
  const std::string name = at.required("mesh", at.text("mesh"), "an asset name, a path or a shape");
  const auto seed = at.integer("seed", 0, 1 << 30);
  if (seed && !has_seed(name)) at.fail("seed", "is for the shapes primitives and foliage");
  if (Mesh shape; make_shape(name, shape, unsigned(seed.value_or(1)))) {
    occluder.mesh = widened(shape);
  } else {
    const std::string file = resolve(at, "mesh", name, "mesh", shape_names);
    occluder.mesh = at_key(at, "mesh", [&] { return import_mesh(file); });
  }
  const bool z_up = read_z_up(at);
  if (z_up) {
    for (dvec3& p : occluder.mesh.positions) p = turned_upright(p);
    for (vec3& n : occluder.mesh.normals) n = vec3(turned_upright(n));
  }
  occluder.spheres = spheres_of(at, occluder.mesh, choice, objective, progress);
  if (z_up && objective.empty())  // fitted ones are of the turned mesh
    for (glm::dvec4& s : occluder.spheres) s = {turned_upright(dvec3(s)), s.w};
  if (auto fit = at.table("fit")) {
    if (occluder.mesh.triangles.empty()) at.fail("fit", "needs a mesh");
    const double height = fit->number("height", tiny, huge).value_or(0.0);
    const bool on_ground = fit->boolean("on_ground").value_or(false);
    const Similarity to_scene =
        fit_to(bounds(occluder.mesh), height, on_ground, read_place(*fit, "at").value_or(dvec3(0.0)));
    for (dvec3& p : occluder.mesh.positions) p = to_scene(p);
    occluder.spheres = transformed(std::move(occluder.spheres), to_scene);
    fit->finish();
  }
  at.finish();
  return occluder;
}

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

Motion read_motion(TomlReader at, dvec3 origin) {
  const std::pair<const char*, Motion::Kind> names[] = {
      {"twist", Motion::Kind::twist}, {"bend", Motion::Kind::bend},
      {"rigid", Motion::Kind::rigid}, {"rotate-light", Motion::Kind::rotate_light},
      {"orbit", Motion::Kind::orbit}, {"dolly", Motion::Kind::dolly}};
  Motion motion;
  const std::string kind = at.required("kind", at.text("kind"), "twist, bend, rigid, rotate-light, orbit or dolly");
  for (const auto& [name, value] : names)
    if (kind == name) motion.kind = value;
  if (motion.kind == Motion::Kind::none)
    at.fail("kind", "is '" + kind + "'; allowed are twist, bend, rigid, rotate-light, orbit, dolly");
  const double most = motion.kind == Motion::Kind::dolly ? 5.0 : 100.0;  // e^5 times as far
  motion.amount = float(at.number("amount", -most, most).value_or(1.0));
  motion.period = float(at.number("period", 1.0, huge).value_or(16.0));
  motion.frames = at.integer("frames", 1, 100000).value_or(16);
  motion.centre = vec3(read_place(at, "centre").value_or(dvec3(0.0)) - origin);
  const std::string carry = at.text("carry").value_or("rigid");
  if (carry == "affine") motion.carry = Carry::affine;
  else if (carry != "rigid") at.fail("carry", "is '" + carry + "'; allowed are rigid, affine");
  at.finish();
  return motion;
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
  const Occluder occluder = read_occluder(section("occluder"), choice, scene.objective, progress);
  scene.receiver_spec = read_receivers(section("receivers"), occluder.mesh, scene.origin);
  scene.light = read_light(section("light"), scene.origin);
  if (auto motion = file.table("motion")) scene.motion = read_motion(*motion, scene.origin);
  scene.receiver_spec.mirrors = read_mirrors(file, scene.origin);
  if (scene.motion.moves_camera() && !std::holds_alternative<Camera>(scene.receiver_spec.kind))
    file.fail("motion", "moves the camera, but the receivers are none");
  check_mirrors(file, scene, !occluder.spheres.empty() || !scene.objective.empty());
  file.finish();
  scene.mesh = narrowed(occluder.mesh, scene.origin);
  if (!scene.mesh.empty()) validate(scene.mesh, scene.name);
  if (const std::size_t coarse = count_coarse(scene.mesh))
    warn(
        "{}: {} of {} triangles lie so far from the receivers that single precision rounds their corners by more than "
        "a thousandth of their size",
        scene.name, coarse, scene.mesh.triangles.size());
  add_mirrors(scene.mesh, scene.receiver_spec.mirrors);
  scene.spheres = narrowed(occluder.spheres, scene.origin);
  scene.receivers = make_receivers(scene.receiver_spec, scene.mesh);
  return scene;
}

}  // namespace penumbra
