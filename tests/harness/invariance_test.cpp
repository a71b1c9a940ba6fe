// What a scene looks like depends neither on where it lies, nor on its unit, nor on what stands far away. Scenes are
// written to files elsewhere and in another unit, loaded, and shaded by the truth and by every technique.
#include <fmt/format.h>

#include "harness/catalogue/catalogue.h"
#include "harness/measure/parity.h"
#include "harness/measure/reference.h"
#include "harness/results/metrics.h"
#include "scenes/assets.h"
#include "scenes/error.h"
#include "scenes/scene_file.h"
#include "tests/support.h"

namespace penumbra {
namespace {

constexpr int edge = 24;  // receivers along an edge: the code is the same for more

/// p -> scale * (p + shift), of a scene's coordinates.
struct Placement {
  double scale = 1.0;
  dvec3 shift{0.0};
  dvec3 operator()(dvec3 p) const { return scale * (p + shift); }
};

std::string text(dvec3 p) {
  return fmt::format("[{:.17e}, {:.17e}, {:.17e}]", p.x, p.y, p.z);
}

std::string write_obj(const Scene& scene, const Placement& place, const test::TemporaryFolder& folder) {
  const Mesh mesh = without_mirrors(scene.mesh, scene.receiver_spec.mirrors);
  std::string obj;
  for (const vec3& p : mesh.positions) {
    const dvec3 q = place(scene.origin + dvec3(p));
    obj += fmt::format("v {:.17g} {:.17g} {:.17g}\n", q.x, q.y, q.z);
  }
  for (const vec3& n : vertex_normals(mesh)) obj += fmt::format("vn {:.9g} {:.9g} {:.9g}\n", n.x, n.y, n.z);
  for (const uvec3& t : mesh.triangles) obj += fmt::format("f {0}//{0} {1}//{1} {2}//{2}\n", t.x + 1, t.y + 1, t.z + 1);
  return folder.write("mesh.obj", obj);
}

std::string receivers_text(const Scene& scene, const Placement& place) {
  const auto at = [&](vec3 p) { return text(place(scene.origin + dvec3(p))); };
  if (const auto* plane = std::get_if<PlaneGrid>(&scene.receiver_spec.kind))
    return fmt::format("plane = {{ half_extent = {:.17e}, resolution = {}, centre = {} }}\n",
                       place.scale * double(plane->half_extent), plane->resolution, at({plane->x, plane->y, plane->z}));
  if (const auto* c = std::get_if<Camera>(&scene.receiver_spec.kind))
    return fmt::format(
        "camera = {{ eye = {}, target = {}, vertical_fov = {:.9e}, width = {}, height = {}, ground = {} }}\n",
        at(c->eye), at(c->target), c->vertical_fov, c->width, c->height,
        c->has_ground ? fmt::format("{:.17e}", place(scene.origin + dvec3(0, c->ground, 0)).y) : "false");
  return "vertices = true\n";
}

std::string light_text(const Scene& scene, const Placement& place) {
  const AreaLight* lamp = area_light_of(scene.light);
  if (!lamp) return "environment = \"constant\"\n";  // replaced after loading: it has no place
  const std::string centre = text(place(scene.origin + dvec3(lamp->centre))), radiance = text(lamp->radiance);
  if (lamp->shape == AreaLight::Shape::disc)
    return fmt::format("area = {{ centre = {}, normal = {}, radius = {:.9e}, radiance = {} }}\n", centre,
                       text(lamp->normal), 0.5 * place.scale * double(glm::length(lamp->edge_u)), radiance);
  return fmt::format("area = {{ centre = {}, edge_u = {}, edge_v = {}, radiance = {} }}\n", centre,
                     text(place.scale * dvec3(lamp->edge_u)), text(place.scale * dvec3(lamp->edge_v)), radiance);
}

std::string mirrors_text(const Scene& scene, const Placement& place) {
  std::string mirrors;
  const auto at = [&](vec3 p) { return text(place(scene.origin + dvec3(p))); };
  for (const Mirror& mirror : scene.receiver_spec.mirrors) {
    mirrors += fmt::format("[[mirror]]\nshadow = {}\n", mirror.shadow);
    if (const auto* ball = std::get_if<Sphere>(&mirror.shape))
      mirrors += fmt::format("sphere = {{ centre = {}, radius = {:.17e} }}\n", at(ball->centre),
                             place.scale * double(ball->radius));
    else if (const auto* wall = std::get_if<MirrorPlane>(&mirror.shape))
      mirrors += fmt::format("plane = {{ centre = {}, edge_u = {}, edge_v = {} }}\n", at(wall->centre),
                             text(place.scale * dvec3(wall->edge_u)), text(place.scale * dvec3(wall->edge_v)));
  }
  return mirrors;
}

/// The scene, written to a file elsewhere and read again.
Scene through_file(const Scene& scene, const Placement& place) {
  const test::TemporaryFolder folder;
  std::string spheres;
  for (const Sphere& s : scene.spheres.spheres) {
    const dvec3 c = place(scene.origin + dvec3(s.centre));
    spheres += fmt::format("[{:.17e}, {:.17e}, {:.17e}, {:.17e}],\n", c.x, c.y, c.z, place.scale * double(s.radius));
  }
  const std::string mesh = scene.mesh.empty() ? "none" : write_obj(scene, place, folder);
  Scene found = load_scene(folder.write(
      "scene.toml",
      fmt::format("name = \"{}\"\n[occluder]\nmesh = \"{}\"\n{}[receivers]\n{}albedo = {}\n[light]\n{}{}", scene.name,
                  mesh, spheres.empty() ? "" : "spheres = [" + spheres + "]\n", receivers_text(scene, place),
                  text(scene.receiver_spec.albedo), light_text(scene, place), mirrors_text(scene, place))));
  if (environment_of(scene.light)) found.light = scene.light;
  return found;
}

/// With a box of the scene's height 10^5 sizes away, as wide as the scene or 10^5 times as wide, and so many heights
/// up: seen from the scene it is a dot or a hair.
Scene with_far_part(const Scene& scene, float width, float up) {
  const Bounds box = bounds(scene.mesh);
  const float size = std::max({box.extent().x, box.extent().y, box.extent().z});
  const vec3 low = box.low + size * vec3(1e5f, up, 0.7e5f);
  const Mesh far = make_box(low, low + size * vec3(width, 1.0f, width));
  Scene out = scene;
  out.mesh = without_mirrors(std::move(out.mesh), scene.receiver_spec.mirrors);
  append(out.mesh, far);
  add_mirrors(out.mesh, scene.receiver_spec.mirrors);
  if (!std::holds_alternative<MeshVertices>(out.receiver_spec.kind))
    out.receivers = make_receivers(out.receiver_spec, out.mesh);
  return out;
}

struct Change {
  const char* name;
  bool exact;  ///< everything rounds as before, so not a bit may change
  std::function<Scene(const Scene&)> make;
};

std::vector<Change> changes() {
  const auto placed = [](double scale, dvec3 shift) {
    return [=](const Scene& s) { return through_file(s, {scale, shift}); };
  };
  const auto moved = [](const Scene& s) {
    const vec3 extent = bounds(s.mesh).extent();
    const double size = std::max({extent.x, extent.y, extent.z});
    return through_file(s, {1.0, 1e4 * size * dvec3(0.81, 0.29, -0.51)});
  };
  return {{"in 2^-20 m", true, placed(0x1p20, dvec3(0.0))},
          {"in 2^20 m", true, placed(0x1p-20, dvec3(0.0))},
          {"moved by 2^20 m", true, placed(1.0, dvec3(0x1p20, 0x1p18, -0x1p19))},
          {"with a part 1e5 sizes away", true, [](const Scene& s) { return with_far_part(s, 1.0f, 0.2f); }},
          {"with a huge part 1e5 sizes away", true, [](const Scene& s) { return with_far_part(s, 1e5f, -1.3f); }},
          {"in micrometres", false, placed(1e6, dvec3(0.0))},
          {"in units of 1000 km", false, placed(1e-6, dvec3(0.0))},
          {"moved by 1e4 sizes", false, moved}};
}

struct Changed {
  Change change;
  Scene scene;
};

Reference truth_of(const Scene& scene) {
  ReferenceSettings settings;
  settings.truth_noise = 0.005;
  settings.most_rays = 4096;
  Animation animation(scene);
  return compute_reference(animation.frame(0), Rung::truth, settings);
}

void expect_same_truth(const Scene& scene, const std::vector<Changed>& all) {
  const Reference usual = truth_of(scene);
  const std::vector<bool> valid = valid_receivers(scene.receivers);
  for (const auto& [change, other] : all) {
    const Reference truth = truth_of(other);
    const double error = std::hypot(usual.noise(valid), truth.noise(valid));
    const double found = rms(difference(truth.mean, usual.mean), valid), scale = rms(usual.mean, valid);
    EXPECT_LE(found, change.exact ? 0.0 : 3.0 * error) << scene.name << " " << change.name;
    fmt::print("{:28} {:32} truth differs by {:.2g} %, three standard errors are {:.2g} %\n", scene.name, change.name,
               100.0 * found / scale, 300.0 * error / scale);
  }
}

/// Techniques with their small parameters, and with every other choice among their knobs.
std::vector<std::pair<const Entry*, Parameters>> variants(const Registry& registry) {
  std::vector<std::pair<const Entry*, Parameters>> all;
  for (const Entry& entry : registry.entries()) {
    if (entry.backend == Backend::cuda) continue;
    const Parameters usual = test::small_parameters(entry);
    all.emplace_back(&entry, usual);
    for (const Knob& knob : entry.knobs)
      for (const ParameterValue& value : knob.values) {
        if (!std::holds_alternative<std::string>(value) || value == usual.all().at(knob.parameter)) continue;
        all.emplace_back(&entry, usual);
        all.back().second.set(knob.parameter, value);
      }
  }
  return all;
}

/// What a technique makes of a scene; empty if it cannot take it.
std::vector<vec3> shaded(Technique& technique, const Scene& scene) {
  try {
    return test::shade(technique, scene);
  } catch (const Unsupported&) {
    return {};
  }
}

void expect_same_techniques(const Scene& scene, const std::vector<Changed>& all) {
  static const Registry registry = make_registry();
  std::map<std::string, std::pair<double, std::string>> worst;
  for (const auto& [entry, parameters] : variants(registry)) {
    if (!entry->lights.accepts(scene.light)) continue;
    const auto technique = entry->make(parameters);
    const std::vector<vec3> usual = shaded(*technique, scene);
    for (const auto& [change, other] : all) {
      const double found = test::difference(shaded(*technique, other), usual);
      // Another size rounds every ray anew; how many of them then miss an edge depends on Embree's instruction set.
      EXPECT_LE(found, change.exact ? 0.0 : 1.5 * entry->parity)
          << scene.name << " " << change.name << ": " << entry->title() << " " << parameters.describe();
      auto& most = worst[change.name];
      if (found / entry->parity >= most.first) most = {found / entry->parity, entry->title()};
    }
  }
  for (const auto& [name, at] : worst)
    fmt::print("{:28} {:32} techniques differ by {:.2g} parities at most ({})\n", scene.name, name, at.first,
               at.second);
}

void expect_invariance(const std::string& name) {
  const Scene whole = through_file(load_scene(name), {});
  if (whole.mesh.empty()) return;
  std::vector<Changed> all;
  for (const Change& change : changes()) all.push_back({change, thinned(change.make(whole), edge)});
  const Scene scene = thinned(whole, edge);
  expect_same_truth(scene, all);
  expect_same_techniques(scene, all);
}

TEST(Invariance, OfTruthAndTechniques) {
  for (const char* name : {"bunny-city-camera", "torus-knot-lamps", "bunny-lamp-camera", "two-blockers", "mirror-lamp"})
    expect_invariance(name);
}

// All of them take some ten minutes: --gtest_also_run_disabled_tests.
TEST(Invariance, DISABLED_OfEveryShippedScene) {
  for (const std::string& name : shipped_names("library")) expect_invariance(name);
}

}  // namespace
}  // namespace penumbra
