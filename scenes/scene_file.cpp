#include "scenes/scene_file.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "scenes/assets.h"
#include "scenes/names.h"
#include "scenes/shapes.h"
#include "scenes/toml_reader.h"

namespace penumbra {
namespace {

constexpr double huge = 1e6;
constexpr double tiny = 1e-6;

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

/// A fit by count keeps the name of its objective in `objective`; spheres from a list or a file leave it empty.
SphereSet read_spheres(TomlReader& at, const Mesh& mesh, const SphereChoice& choice, std::string& objective) {
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
    if (mesh.empty()) at.fail("spheres", "asks for a fit, but there is no mesh");
    return at_key(at, "spheres", [&] { return cached_fit(mesh, request, *at.text("mesh")); });
  }
  if (!node) return {};
  if (node->is_string()) {
    const auto path = std::filesystem::path(at.file()).parent_path() / *at.text("spheres");
    return at_key(at, "spheres", [&] { return load_spheres(path.string()); });
  }
  const toml::array* list = node->as_array();
  if (!list) at.fail("spheres", "must be a count, a file name or a list of [x, y, z, radius]");
  SphereSet set;
  for (const toml::node& item : *list) {
    const toml::array* four = item.as_array();
    double v[4];
    bool good = four && four->size() == 4;
    for (std::size_t k = 0; good && k < 4; ++k) {
      good = four->get(k)->is_number();
      if (good) v[k] = *four->get(k)->value<double>();
      good = good && std::abs(v[k]) <= huge;
    }
    if (!good || v[3] < 0)
      at.fail("spheres", fmt::format("[{}] must be four finite numbers [x, y, z, radius >= 0]", set.size()));
    set.spheres.push_back({vec3(v[0], v[1], v[2]), float(v[3])});
  }
  return set;
}

void read_occluder(TomlReader at, const SphereChoice& choice, Scene& scene) {
  const std::string name = at.required("mesh", at.text("mesh"), "an asset name, a path or a shape");
  const auto seed = at.integer("seed", 0, 1 << 30);
  if (seed && name != "primitives") at.fail("seed", "is for the shape primitives");
  if (!make_shape(name, scene.mesh, unsigned(seed.value_or(1)))) {
    const std::string file = resolve(at, "mesh", name, "mesh", shape_names);
    scene.mesh = at_key(at, "mesh", [&] { return load_mesh(file); });
  }
  scene.spheres = read_spheres(at, scene.mesh, choice, scene.objective);
  if (auto fit = at.table("fit")) {
    if (scene.mesh.empty()) at.fail("fit", "needs a mesh");
    const double height = fit->number("height", tiny, huge).value_or(0.0);
    const Similarity to_scene = fit_to(bounds(scene.mesh), float(height), fit->boolean("on_ground").value_or(false));
    for (vec3& p : scene.mesh.positions) p = to_scene(p);
    scene.spheres = transformed(std::move(scene.spheres), to_scene);
    fit->finish();
  }
  at.finish();
}

/// The one key of `kinds` that is there.
std::string exactly_one(TomlReader& at, const std::vector<std::string>& kinds) {
  std::vector<std::string> found;
  for (const auto& kind : kinds)
    if (at.has(kind)) found.push_back(kind);
  if (found.size() != 1)
    throw Error("{}: [{}] has {}; exactly one of {} is allowed", at.where(found.size() > 1 ? found[1] : ""),
                at.name("").substr(0, at.name("").size() - 1),
                found.empty() ? "no kind" : fmt::format("{}", fmt::join(found, " and ")), fmt::join(kinds, ", "));
  return found[0];
}

ReceiverSpec read_receivers(TomlReader at) {
  ReceiverSpec spec;
  const std::string kind = exactly_one(at, {"plane", "vertices", "camera"});
  if (kind == "plane") {
    TomlReader in = *at.table("plane");
    PlaneGrid plane;
    plane.half_extent = float(in.required("half_extent", in.number("half_extent", tiny, huge), "metres"));
    plane.resolution = in.required("resolution", in.integer("resolution", 1, 4096), "receivers along an edge");
    plane.y = float(in.number("y", -huge, huge).value_or(0.0));
    in.finish();
    spec.kind = plane;
  } else if (kind == "camera") {
    TomlReader in = *at.table("camera");
    Camera camera;
    camera.eye = in.required("eye", in.vector("eye"), "[x, y, z]");
    camera.target = in.required("target", in.vector("target"), "[x, y, z]");
    if (camera.eye == camera.target) in.fail("target", "is the eye itself");
    camera.vertical_fov = float(in.number("vertical_fov", 1.0, 170.0).value_or(45.0));
    camera.width = in.required("width", in.integer("width", 1, 8192), "pixels");
    camera.height = in.required("height", in.integer("height", 1, 8192), "pixels");
    const toml::node* ground = in.node("ground");
    if (ground && ground->is_boolean()) camera.has_ground = *in.boolean("ground");
    else camera.ground = float(in.number("ground", -huge, huge).value_or(0.0));
    in.finish();
    spec.kind = camera;
  } else {
    if (!*at.boolean("vertices")) at.fail("vertices", "must be true, or absent");
    spec.kind = MeshVertices{};
  }
  if (const auto albedo = at.vector("albedo")) {
    if (glm::any(glm::lessThan(*albedo, vec3(0.0f))) || glm::any(glm::greaterThan(*albedo, vec3(1.0f))))
      at.fail("albedo", "must lie in [0, 1]");
    spec.albedo = *albedo;
  }
  at.finish();
  return spec;
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

/// A direction of any length but 0, as a unit vector: lengths that no float holds are fine.
std::optional<vec3> read_direction(TomlReader& at, const std::string& key) {
  const toml::node* node = at.node(key);
  if (!node) return {};
  const toml::array* three = node->as_array();
  bool good = three && three->size() == 3;
  dvec3 v(0.0);
  for (int k = 0; good && k < 3; ++k) {
    v[k] = three->get(std::size_t(k))->value<double>().value_or(NAN);
    good = three->get(std::size_t(k))->is_number() && std::isfinite(v[k]);
  }
  if (!good) at.fail(key, "must be three finite numbers [x, y, z]");
  const double largest = std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
  if (largest == 0.0) at.fail(key, "must not be zero");
  return vec3(glm::normalize(v / largest));
}

/// A place or an edge of a lamp. Farther out the square of a distance is no float.
std::optional<vec3> read_length(TomlReader& at, const std::string& key) {
  constexpr float most = 1e12f;
  const auto v = at.vector(key);
  if (v && glm::any(glm::greaterThan(glm::abs(*v), vec3(most))))
    at.fail(key, fmt::format("holds a number outside [{}, {}]", -most, most));
  return v;
}

AreaLight read_area_light(TomlReader at) {
  const vec3 centre = at.required("centre", read_length(at, "centre"), "[x, y, z]");
  const auto radiance = at.vector("radiance").value_or(vec3(1.0f));
  if (glm::any(glm::lessThan(radiance, vec3(0.0f)))) at.fail("radiance", "must not be negative");
  AreaLight light;
  if (at.has("radius")) {
    const double radius = *at.number("radius", 0.0, huge);
    const vec3 normal = at.required("normal", read_direction(at, "normal"), "the side it shines to");
    light = make_disc(centre, normal, float(radius), radiance);
  } else {
    const vec3 u =
        at.required("edge_u", read_length(at, "edge_u"), "a rectangle's edge (a disc has normal and radius)");
    const vec3 v = at.required("edge_v", read_length(at, "edge_v"), "a rectangle's edge");
    light = make_rectangle(centre, u, v, radiance);
  }
  at.finish();
  return light;
}

Light read_light(TomlReader at) {
  const std::string kind = exactly_one(at, {"environment", "area"});
  if (kind == "area") {
    AreaLight light = read_area_light(*at.table("area"));
    at.finish();
    return light;
  }
  const std::string name = *at.text("environment");
  const Layout layout = read_layout(at);
  Environment environment;
  if (!make_environment(name, environment)) {
    const std::string file = resolve(at, "environment", name, "environment", environment_names);
    environment = at_key(at, "environment", [&] { return load_environment(file, layout); });
  }
  environment.rotation = at.number("rotation", -100.0, 100.0).value_or(0.0);
  at.finish();
  return environment;
}

Motion read_motion(TomlReader at) {
  const std::pair<const char*, Motion::Kind> names[] = {{"twist", Motion::Kind::twist},
                                                        {"bend", Motion::Kind::bend},
                                                        {"rigid", Motion::Kind::rigid},
                                                        {"rotate-light", Motion::Kind::rotate_light}};
  Motion motion;
  const std::string kind = at.required("kind", at.text("kind"), "twist, bend, rigid or rotate-light");
  for (const auto& [name, value] : names)
    if (kind == name) motion.kind = value;
  if (motion.kind == Motion::Kind::none)
    at.fail("kind", "is '" + kind + "'; allowed are twist, bend, rigid, rotate-light");
  motion.amount = float(at.number("amount", -100.0, 100.0).value_or(1.0));
  motion.period = float(at.number("period", 1.0, huge).value_or(16.0));
  motion.frames = at.integer("frames", 1, 100000).value_or(16);
  const std::string carry = at.text("carry").value_or("rigid");
  if (carry == "affine") motion.carry = Carry::affine;
  else if (carry != "rigid") at.fail("carry", "is '" + carry + "'; allowed are rigid, affine");
  at.finish();
  return motion;
}

}  // namespace

std::string read_name(TomlReader& file) {
  const std::string name = file.required("name", file.text("name"), "a name for tables");
  if (const std::string fault = name_fault(name); !fault.empty()) file.fail("name", fault);
  return name;
}

SceneName read_scene_name(const std::string& name_or_path) {
  const std::string path = shipped_file(name_or_path, "library");
  TomlReader file = TomlReader::open(path);
  return {read_name(file), path, file.where("name")};
}

Scene load_scene(const std::string& name_or_path, const SphereChoice& choice) {
  TomlReader file = TomlReader::open(shipped_file(name_or_path, "library"));
  Scene scene;
  scene.name = read_name(file);
  const auto section = [&](const char* key) { return file.required(key, file.table(key), "a table"); };
  read_occluder(section("occluder"), choice, scene);
  scene.receiver_spec = read_receivers(section("receivers"));
  scene.light = read_light(section("light"));
  if (auto motion = file.table("motion")) scene.motion = read_motion(*motion);
  file.finish();
  if (std::holds_alternative<MeshVertices>(scene.receiver_spec.kind) && scene.mesh.empty())
    file.fail("receivers", "asks for vertices, but the occluder has no mesh");
  scene.receivers = make_receivers(scene.receiver_spec, scene.mesh);
  return scene;
}

}  // namespace penumbra
