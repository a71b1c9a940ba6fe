#include "scenes/entities_file.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>

#include "scenes/names.h"
#include "scenes/scene_keys.h"
#include "scenes/shapes.h"

namespace penumbra {
namespace {

Objective read_objective(TomlReader& at) {
  const auto name = at.text("objective");
  if (!name) return FitRequest().objective;
  return at_key(at, "objective", [&] { return parse_objective(*name); });
}

/// One of them.
struct Thing {
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

/// All keys of a table but `name` and `motion`.
Thing read_thing(TomlReader& at, const SphereChoice& choice, const FitProgress& progress, EntityList& list) {
  Thing thing;
  std::string objective;
  const std::string name = at.required("mesh", at.text("mesh"), "an asset name, a path or a shape");
  const auto seed = at.integer("seed", 0, 1 << 30);
  if (seed && !has_seed(name)) at.fail("seed", "is for the shapes primitives and foliage");
  if (Mesh shape; make_shape(name, shape, unsigned(seed.value_or(1)))) {
    thing.mesh = widened(shape);
  } else {
    const std::string file = resolve(at, "mesh", name, "mesh", shape_names);
    thing.mesh = at_key(at, "mesh", [&] { return import_mesh(file); });
  }
  const bool z_up = read_z_up(at);
  if (z_up) {
    for (dvec3& p : thing.mesh.positions) p = turned_upright(p);
    for (vec3& n : thing.mesh.normals) n = vec3(turned_upright(n));
  }
  thing.spheres = spheres_of(at, thing.mesh, choice, objective, progress);
  if (!thing.spheres.empty() || !objective.empty()) list.objective.add(objective);
  if (z_up && objective.empty())  // fitted ones are of the turned mesh
    for (glm::dvec4& s : thing.spheres) s = {turned_upright(dvec3(s)), s.w};
  if (auto fit = at.table("fit")) {
    if (thing.mesh.triangles.empty()) at.fail("fit", "needs a mesh");
    const double height = fit->number("height", tiny, huge).value_or(0.0);
    const bool on_ground = fit->boolean("on_ground").value_or(false);
    const Similarity to_scene =
        fit_to(bounds(thing.mesh), height, on_ground, read_place(*fit, "at").value_or(dvec3(0.0)));
    for (dvec3& p : thing.mesh.positions) p = to_scene(p);
    thing.spheres = transformed(std::move(thing.spheres), to_scene);
    fit->finish();
  }
  return thing;
}

/// Adds one to the list.
void append(EntityList& list, Thing&& thing, std::string name) {
  const auto grow = [](auto& to, auto& from) {
    const Entity::Range range{to.size(), from.size()};
    to.insert(to.end(), from.begin(), from.end());
    return range;
  };
  ImportedMesh& all = list.mesh;
  const std::size_t before = all.positions.size();
  const bool shaded = !all.normals.empty() || !thing.mesh.normals.empty();
  for (uvec3& t : thing.mesh.triangles) t += unsigned(before);
  if (shaded) all.normals.resize(before, vec3(0.0f));
  all.normals.insert(all.normals.end(), thing.mesh.normals.begin(), thing.mesh.normals.end());
  Entity entity;
  entity.name = std::move(name);
  entity.vertices = grow(all.positions, thing.mesh.positions);
  entity.triangles = grow(all.triangles, thing.mesh.triangles);
  entity.spheres = grow(list.spheres, thing.spheres);
  if (shaded) all.normals.resize(all.positions.size(), vec3(0.0f));
  list.entities.push_back(std::move(entity));
}

void read_entity(TomlReader& at, const SphereChoice& choice, const FitProgress& progress, EntityList& list) {
  std::string name = at.text("name").value_or(fmt::format("entity {}", list.entities.size() + 1));
  if (const std::string fault = name_fault(name); !fault.empty()) at.fail("name", fault);
  for (const Entity& other : list.entities)
    if (other.name == name) at.fail("name", "is '" + name + "', which another entity is called");
  Thing thing = read_thing(at, choice, progress, list);
  list.motions.push_back(at.table("motion"));
  at.finish();
  append(list, std::move(thing), std::move(name));
}

/// The kinds of which `allowed` is true.
Motion read_motion_of(TomlReader& at, dvec3 origin, dvec3 centre, bool (*allowed)(const Motion&)) {
  const std::pair<const char*, Motion::Kind> names[] = {
      {"twist", Motion::Kind::twist}, {"bend", Motion::Kind::bend},
      {"rigid", Motion::Kind::rigid}, {"rotate-light", Motion::Kind::rotate_light},
      {"orbit", Motion::Kind::orbit}, {"dolly", Motion::Kind::dolly}};
  Motion motion;
  const std::string kind = at.required("kind", at.text("kind"), "how things move");
  std::vector<std::string> known;
  for (const auto& [name, value] : names) {
    Motion one;
    one.kind = value;
    if (!allowed(one)) continue;
    known.emplace_back(name);
    if (kind == name) motion.kind = value;
  }
  if (motion.kind == Motion::Kind::none)
    at.fail("kind", fmt::format("is '{}'; allowed are {}", kind, fmt::join(known, ", ")));
  const double most = motion.kind == Motion::Kind::dolly ? 5.0 : 100.0;  // e^5 times as far
  motion.amount = float(at.number("amount", -most, most).value_or(1.0));
  motion.period = float(at.number("period", 1.0, huge).value_or(16.0));
  motion.frames = at.integer("frames", 1, 100000).value_or(16);
  motion.centre = vec3(read_place(at, "centre").value_or(centre) - origin);
  motion.travel = vec3(read_place(at, "travel").value_or(dvec3(0.0)));
  if (motion.travel != vec3(0.0f) && !motion.moves_occluder()) at.fail("travel", "is for what blocks light");
  for (const char* key : {"centre", "carry"})
    if (motion.moves_camera() && at.has(key)) at.fail(key, "means nothing to a camera");
  const std::string carry = at.text("carry").value_or("rigid");
  if (carry == "affine") motion.carry = Carry::affine;
  else if (carry != "rigid") at.fail("carry", "is '" + carry + "'; allowed are rigid, affine");
  at.finish();
  return motion;
}

/// Of an entity's box; of its spheres' centres where it has no mesh.
dvec3 middle_of(const EntityList& list, const Entity& entity) {
  dvec3 low(std::numeric_limits<double>::infinity()), high = -low;
  const auto take = [&](dvec3 p) { low = glm::min(low, p), high = glm::max(high, p); };
  for (std::size_t i = entity.vertices.first; i < entity.vertices.end(); ++i) take(list.mesh.positions[i]);
  if (entity.vertices.count == 0)
    for (std::size_t i = entity.spheres.first; i < entity.spheres.end(); ++i) take(dvec3(list.spheres[i]));
  return low.x <= high.x ? 0.5 * (low + high) : dvec3(0.0);
}

}  // namespace

std::vector<SphereChoice> choices_of(std::vector<TomlReader>& entities, const SphereChoice& choice) {
  std::vector<SphereChoice> choices(entities.size(), choice);
  const auto has_mesh = [](TomlReader& at) { return at.text("mesh").value_or("") != "none"; };
  const int meshes = int(std::count_if(entities.begin(), entities.end(), has_mesh));
  if (entities.size() < 2 || meshes == 0) return choices;
  for (std::size_t k = 0, mesh = 0; k < entities.size(); ++k) {
    if (!has_mesh(entities[k])) choices[k].count.reset(), choices[k].objective.reset();
    else if (choice.count)
      choices[k].count = std::max(1, *choice.count / meshes + (int(mesh++) < *choice.count % meshes));
  }
  return choices;
}

EntityList read_entities(TomlReader& file, const SphereChoice& choice, const FitProgress& progress) {
  EntityList list;
  std::vector<TomlReader> several = file.tables("entity");
  std::optional<TomlReader> one = file.table("occluder");
  if (one && !several.empty())
    file.fail("occluder", "is one thing, and [[entity]] is several: write it as one of these");
  if (one) {
    Thing thing = read_thing(*one, choice, progress, list);
    one->finish();
    list.motions.emplace_back();
    append(list, std::move(thing), "occluder");
  }
  const std::vector<SphereChoice> choices = choices_of(several, choice);
  for (std::size_t k = 0; k < several.size(); ++k) read_entity(several[k], choices[k], progress, list);
  if (list.entities.empty()) file.required("occluder", one, "a table, or one [[entity]] for each thing");
  return list;
}

void read_motions_of_entities(EntityList& list, dvec3 origin) {
  for (std::size_t k = 0; k < list.entities.size(); ++k)
    if (std::optional<TomlReader>& at = list.motions[k])
      list.entities[k].motion = read_motion_of(*at, origin, middle_of(list, list.entities[k]),
                                               [](const Motion& m) { return m.moves_occluder(); });
}

Motion read_motion(TomlReader at, dvec3 origin) {
  return read_motion_of(at, origin, dvec3(0.0), [](const Motion&) { return true; });
}

}  // namespace penumbra
