#include "harness/commands/describe.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <map>
#include <set>

#include "harness/measure/plan.h"
#include "harness/report/screen.h"
#include "scenes/assets.h"
#include "scenes/toml_reader.h"

namespace penumbra {
namespace {

constexpr int column = 14;

std::vector<const Entry*> entries_of(const std::string& technique, const Registry& registry) {
  std::vector<const Entry*> entries;
  for (const Entry& entry : registry.entries())
    if (entry.name == technique) entries.push_back(&entry);
  if (entries.empty()) registry.find(technique, "");  // which throws
  return entries;
}

/// The shipped suites that have a row of a technique, and of their scenes the first that it can shade.
struct Measured {
  std::vector<std::string> suites;
  std::string scene;
};

Measured measured_by_suites(const Entry& entry, const Registry& registry) {
  Measured measured;
  for (const std::string& name : shipped_names("suites")) {
    const Suite suite = load_suite(name, registry, 0);
    const auto same = [&](const Variant& v) { return v.entry->name == entry.name; };
    if (!std::any_of(suite.variants.begin(), suite.variants.end(), same)) continue;
    measured.suites.push_back(name);
    for (const std::string& scene : suite.scenes) {
      const SceneOutline outline = read_outline(scene);
      const bool fits = (entry.lights.environment || !outline.environment) && (entry.lights.area || !outline.lamps);
      if (measured.scene.empty() && fits) measured.scene = scene;
    }
  }
  return measured;
}

std::string parameters_of(const std::vector<const Entry*>& entries, int width) {
  std::set<std::string> seen;
  std::string text;
  for (const Entry* entry : entries)
    for (const Parameter& p : entry->parameters) {
      if (!seen.insert(p.name).second) continue;
      const auto lacks = [&](const Entry* other) {
        return std::none_of(other->parameters.begin(), other->parameters.end(),
                            [&](const Parameter& q) { return q.name == p.name; });
      };
      const std::string alone =
          std::any_of(entries.begin(), entries.end(), lacks) ? " (" + to_string(entry->backend) + " alone)" : "";
      const std::string unit = p.unit.empty() ? "" : " " + p.unit;
      text += labelled(fmt::format("{} = {}{}", p.name, to_string(p.fallback), unit),
                       fmt::format("{} {}{}", p.allowed.empty() ? p.range() : "(" + p.range() + ")", p.meaning, alone),
                       30, width);
    }
  return text.empty() ? text : "parameters and their defaults\n" + text;
}

std::string vector_text(vec3 v) {
  return fmt::format("({:.4g}, {:.4g}, {:.4g})", v.x, v.y, v.z);
}

std::string mesh_text(const Scene& scene, std::string name) {
  if (scene.entities.size() > 1) name = fmt::format("{} entities", scene.entities.size());
  const Mesh mesh = without_mirrors(scene.mesh, scene.receiver_spec.mirrors);
  if (mesh.empty()) return name;
  const vec3 extent = bounds(mesh).extent();
  return fmt::format("{}: {} triangles, {:.3g} x {:.3g} x {:.3g} m", name, mesh.triangles.size(), extent.x, extent.y,
                     extent.z);
}

std::string spheres_text(const SceneOutline& outline) {
  if (outline.spheres == 0) return "none: techniques that need them are skipped";
  const std::string origin = outline.origin_of_spheres();
  return fmt::format("{}, {}{}", outline.spheres, origin.starts_with("for ") ? "fitted " : "", origin);
}

std::string mirrors_text(const ReceiverSpec& spec) {
  const std::size_t count = spec.mirrors.size();
  return count == 0 ? "" : fmt::format(", with {} mirror{}", count, count == 1 ? "" : "s");
}

std::string receivers_text(const Scene& scene) {
  const Receivers& r = scene.receivers;
  const std::string count = fmt::format("{} x {} = {}", r.width, r.height, r.size());
  if (const auto* plane = std::get_if<PlaneGrid>(&scene.receiver_spec.kind))
    return fmt::format("{} on a horizontal square {:.4g} m wide", count, 2.0 * double(plane->half_extent));
  if (const auto* camera = std::get_if<Camera>(&scene.receiver_spec.kind))
    return fmt::format("{} pixels of a camera at {}, looking at {}{}", count,
                       vector_text(vec3(dvec3(camera->eye) + scene.origin)),
                       vector_text(vec3(dvec3(camera->target) + scene.origin)), mirrors_text(scene.receiver_spec));
  return fmt::format("{}, the vertices of the mesh", r.size());
}

std::string light_text(const Scene& scene, const Light& light, const std::string& environment) {
  if (const Environment* e = environment_of(light))
    return fmt::format("environment {}{}", environment,
                       e->rotation != 0.0 ? fmt::format(", turned by {:.3g} rad about +y", e->rotation) : "");
  if (std::holds_alternative<Lights>(light)) {
    std::vector<std::string> texts;
    for (const Light& one : each_of(light)) texts.push_back(light_text(scene, one, environment));
    return fmt::format("{}", fmt::join(texts, "; "));
  }
  const AreaLight& lamp = *area_light_of(light);
  return fmt::format("{} lamp of {:.3g} m^2 at {}, radiance {} W m^-2 sr^-1",
                     lamp.shape == AreaLight::Shape::disc ? "round" : "rectangular", lamp.area(),
                     vector_text(vec3(dvec3(lamp.centre) + scene.origin)), vector_text(lamp.radiance));
}

std::string motion_text(const Scene& scene, const std::string& kind) {
  const Motion& motion = scene.motion;
  const auto own = std::count_if(scene.entities.begin(), scene.entities.end(),
                                 [](const Entity& e) { return e.motion.kind != Motion::Kind::none; });
  if (own > 0)
    return fmt::format("{} of {} entities move{}", own, scene.entities.size(),
                       motion.kind == Motion::Kind::none ? "" : "; " + kind);
  if (motion.kind == Motion::Kind::none) return "none";
  const bool dolly = motion.kind == Motion::Kind::dolly;
  return fmt::format("{} by {:.3g} {}, period {:.4g} frames, {} frames", kind,
                     dolly ? std::exp(motion.amount) : motion.amount, dolly ? "times" : "rad", motion.period,
                     motion.frames);
}

/// "8, 16; for cover, shadow": what replaces the scenes' own spheres.
std::string choices_text(const std::vector<SphereChoice>& choices) {
  std::vector<std::string> texts;
  texts.reserve(choices.size());
  for (const SphereChoice& choice : choices)
    texts.push_back(fmt::format("{}{}", choice.count ? std::to_string(*choice.count) : "the scenes' own number",
                                choice.objective ? " for " + to_string(*choice.objective) : ""));
  return fmt::format("{}", fmt::join(texts, ", "));
}

}  // namespace

std::vector<std::string> technique_names(const Registry& registry) {
  std::vector<std::string> names;
  for (const Entry& entry : registry.entries())
    if (std::find(names.begin(), names.end(), entry.name) == names.end()) names.push_back(entry.name);
  return names;
}

std::string backends_of(const std::string& technique, const Registry& registry) {
  std::vector<std::string> texts;
  for (const Entry* entry : entries_of(technique, registry))
    texts.push_back(to_string(entry->backend) + (entry->unavailable.empty() ? "" : " (not here)"));
  return fmt::format("{}", fmt::join(texts, ", "));
}

std::string lights_of(const LightKinds& lights) {
  if (lights.environment && lights.area) return "environments, lamps";
  return lights.environment ? "environments" : lights.area ? "lamps" : "none";
}

std::string describe_technique(const std::string& name, const Registry& registry, int width) {
  const std::vector<const Entry*> entries = entries_of(name, registry);
  const Entry& first = *entries.front();
  const Measured measured = measured_by_suites(first, registry);
  std::string text = wrapped(fmt::format("{}: {}", name, first.summary), width) + "\n";
  const auto line = [&](const char* label, const std::string& what) { text += labelled(label, what, column, width); };
  if (!first.citation.empty()) line("after", first.citation);
  line("lights", lights_of(first.lights));
  line("backends", backends_of(name, registry));
  for (const Entry* entry : entries)
    if (!entry->unavailable.empty()) line("", fmt::format("{}: {}", to_string(entry->backend), entry->unavailable));
  line("suites", measured.suites.empty() ? "none" : fmt::format("{}", fmt::join(measured.suites, ", ")));
  if (!measured.scene.empty())
    line("try", fmt::format("penumbra render {} --technique {} -o {}.png", measured.scene, name, name));
  return text + parameters_of(entries, width);
}

std::string describe_scene(const std::string& name_or_path, int width) {
  const std::string file = shipped_file(name_or_path, "library");
  const SceneOutline outline = read_outline(file);
  SphereChoice without_fit;
  without_fit.fitted = false;
  const Scene scene = load_scene(file, without_fit);
  TomlReader reader = TomlReader::open(file);
  const auto named = [&](const char* table, const char* key) {
    auto at = reader.table(table);
    return at ? at->text(key).value_or("") : "";
  };
  std::string text = wrapped(fmt::format("{}: scene {}", scene.name, file), width) + "\n";
  const auto line = [&](const char* label, const std::string& what) { text += labelled(label, what, column, width); };
  line("mesh", mesh_text(scene, named("occluder", "mesh")));
  line("spheres", spheres_text(outline));
  line("receivers", receivers_text(scene));
  line("light", light_text(scene, scene.light, named("light", "environment")));
  line("motion", motion_text(scene, named("motion", "kind")));
  line("try", fmt::format("penumbra choose {0} --error 2%, penumbra run quick --scene {0}", name_or_path));
  return text;
}

std::string describe_suite(const std::string& name_or_path, const Registry& registry, int width) {
  const Suite suite = load_suite(name_or_path, registry, 0);
  std::size_t rows = 0;
  const Plan plan = make_plan(suite, ".*", 0);
  for (const PlannedScene& scene : plan.scenes) rows += scene.measurements();
  std::string text =
      wrapped(fmt::format("{}: suite {}", suite.name, shipped_file(name_or_path, "suites")), width) + "\n";
  const auto line = [&](const char* label, const std::string& what) { text += labelled(label, what, column, width); };
  line("scenes", fmt::format("{}", fmt::join(suite.scenes, ", ")));
  if (suite.spheres.size() > 1 || suite.spheres[0].count || suite.spheres[0].objective)
    line("spheres", choices_text(suite.spheres));
  line("settings",
       fmt::format("{} repetitions, truth noise {:.3g} %{}{}", suite.repetitions, 100.0 * suite.truth_noise,
                   suite.sequence ? ", every frame scored" : "", suite.attribution ? ", errors attributed" : ""));
  if (suite.baseline) line("baseline", spaced(suite.baseline->label()));
  if (!suite.published.empty()) line("published", suite.published);
  line("rows", fmt::format("{} on all scenes; of each:", rows));
  for (const Variant& variant : suite.variants) line("", spaced(variant.label()));
  line("try", fmt::format("penumbra run {0} --dry-run, penumbra run {0}", name_or_path));
  return text;
}

}  // namespace penumbra
