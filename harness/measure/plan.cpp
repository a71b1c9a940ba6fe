#include "harness/measure/plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <set>

#include "scenes/assets.h"
#include "scenes/content.h"
#include "scenes/error.h"
#include "scenes/names.h"
#include "scenes/pattern.h"

namespace penumbra {
namespace {

/// read_outline(); a scene that is not there is a mistake of the suite.
SceneOutline outline_of(const Suite& suite, const std::string& listed, const SphereChoice& choice = {}) {
  std::string file = listed;
  try {
    file = shipped_file(listed, "library");
  } catch (const Error& e) {
    throw Error("{}: {}", suite.scenes_where, e.what());
  }
  if (!std::filesystem::is_regular_file(file))
    throw Error("{}: {} is no file; paths in a suite start at its folder", suite.scenes_where, file);
  return read_outline(file, choice);
}

/// Every scene once, and no two whose tables and image folders would be the same.
void check_scene_names(const Suite& suite) {
  std::map<std::string, SceneOutline> seen;
  for (const std::string& listed : suite.scenes) {
    const SceneOutline scene = outline_of(suite, listed);
    const auto [at, fresh] = seen.try_emplace(file_name_key(scene.name), scene);
    if (fresh) continue;
    const SceneOutline& other = at->second;
    if (std::filesystem::equivalent(other.file, scene.file))
      throw Error("{} lists {} twice; allowed is once (the key 'spheres' measures it with several sets)",
                  suite.scenes_where, listed);
    throw Error(
        "{} lists '{}' ({}) and '{}' ({}), which would share tables and images; allowed are names that "
        "differ in more than case and ' ', ':' or '-'",
        suite.scenes_where, other.name, other.where, scene.name, scene.where);
  }
}

/// "scene/spheres:64/objective:shadow".
std::string title_of(const SceneOutline& scene) {
  return fmt::format("{}/spheres:{}{}{}", scene.name, scene.spheres,
                     scene.objective.empty() ? "" : "/objective:", scene.objective);
}

/// The rungs that apply, each at every resolution that is asked for.
void add_references(const std::set<int>& resolutions, const std::string& fit, PlannedScene& scene) {
  for (const Rung rung : {Rung::truth, Rung::r13x13, Rung::cube, Rung::spheres}) {
    const bool texels = rung == Rung::cube || rung == Rung::spheres;
    if (texels ? scene.outline.lamps : rung == Rung::r13x13 && scene.outline.environment) continue;
    if (rung == Rung::spheres && scene.outline.spheres == 0) continue;
    for (const int n : texels ? resolutions : std::set<int>{0}) {
      std::string key = fmt::format("reference {}/{}", title_of(scene.outline), to_string(rung));
      if (n) key += fmt::format("/resolution:{}", n);
      scene.jobs.push_back({Job::Kind::reference, key, {fit}, rung, n});
    }
  }
}

void add_jobs(const Suite& suite, const std::vector<std::size_t>& variants, PlannedScene& scene) {
  const std::string title = title_of(scene.outline), fit = "fit " + title;
  scene.jobs.push_back({Job::Kind::fit, fit, {}});
  std::set<int> resolutions;
  for (const std::size_t k : variants) resolutions.insert(resolution_of(suite.variants[k].parameters));
  add_references(resolutions, fit, scene);
  if (suite.baseline)
    scene.jobs.push_back({Job::Kind::baseline, "baseline " + title + "/" + suite.baseline->label(), {fit}});
  if (suite.sequence) scene.jobs.push_back({Job::Kind::sequence, "sequence " + title, {fit}});
  std::vector<std::string> needs;
  for (const Job& job : scene.jobs) needs.push_back(job.key);
  for (const std::size_t k : variants) {
    Job job{Job::Kind::measurement, "measurement " + identity_of(scene.outline, suite.variants[k]).name(), needs};
    job.variant = k;
    scene.jobs.push_back(std::move(job));
  }
}

/// Why no variant that is left can run; empty if one can.
std::string nothing_runs(const Suite& suite, const std::set<std::size_t>& left) {
  std::map<std::string, std::string> reasons;  // by backend
  for (const std::size_t k : left) {
    const Entry& entry = *suite.variants[k].entry;
    if (entry.unavailable.empty()) return "";
    reasons[to_string(entry.backend)] = entry.unavailable;
  }
  std::string text;
  for (const auto& [backend, reason] : reasons)
    text += fmt::format("{}{}: {}", text.empty() ? "" : "; ", backend, reason);
  return text;
}

}  // namespace

int resolution_of(const Parameters& parameters) {
  const auto at = parameters.all().find("resolution");
  return at == parameters.all().end() ? 32 : std::get<int>(at->second);
}

std::size_t PlannedScene::measurements() const {
  return std::size_t(
      std::count_if(jobs.begin(), jobs.end(), [](const Job& job) { return job.kind == Job::Kind::measurement; }));
}

RowIdentity identity_of(const SceneOutline& scene, const Variant& variant) {
  const Entry& entry = *variant.entry;
  RowIdentity id;
  id.scene = scene.name;
  id.spheres = scene.spheres;
  id.objective = scene.objective;
  id.reads_spheres = entry.reads_spheres(variant.parameters);
  id.technique = entry.name;
  id.backend = to_string(entry.backend);
  id.parameters = variant.parameters.all();
  for (const Parameter& p : entry.parameters) id.defaults[p.name] = p.fallback;
  id.threads = variant.threads;
  return id;
}

Plan make_plan(const Suite& suite, const std::string& filter, int repetitions) {
  const Pattern wanted("--filter", filter);
  check_scene_names(suite);
  Plan plan{&suite, repetitions > 0 ? repetitions : suite.repetitions, {}};
  std::set<std::string> titles;
  std::set<std::size_t> left;
  for (const std::string& listed : suite.scenes) {
    std::set<std::size_t> without_spheres;  // variants that do not look at them and have their turn
    for (const SphereChoice& choice : suite.spheres) {
      PlannedScene scene{listed, choice, outline_of(suite, listed, choice), {}};
      const SceneOutline& o = scene.outline;
      if (!titles.insert(title_of(o)).second)
        throw Error("{}: scene '{}' has {} spheres{}{} twice; allowed are choices of spheres that differ",
                    suite.spheres_where, o.name, o.spheres, o.objective.empty() ? "" : " for ", o.objective);
      std::vector<std::size_t> variants;
      for (std::size_t k = 0; k < suite.variants.size(); ++k) {
        const RowIdentity id = identity_of(o, suite.variants[k]);
        if (!is_in(wanted, id)) continue;
        if (id.reads_spheres || without_spheres.insert(k).second) variants.push_back(k);
      }
      if (variants.empty()) continue;
      left.insert(variants.begin(), variants.end());
      add_jobs(suite, variants, scene);
      plan.scenes.push_back(std::move(scene));
    }
  }
  if (plan.scenes.empty()) throw Error("--filter '{}' leaves nothing of suite '{}'", filter, suite.name);
  if (const std::string why = nothing_runs(suite, left); !why.empty())
    throw Error("nothing of suite '{}' can run here: {}", suite.name, why);
  return plan;
}

namespace {

void add_motion(ContentHash& hash, const Motion& motion) {
  hash.add_value(int(motion.kind)), hash.add_value(int(motion.carry));
  hash.add_value(motion.amount), hash.add_value(motion.period), hash.add_value(motion.frames);
  add_vec(hash, motion.centre);
  if (motion.travel != vec3(0.0f)) add_vec(hash, motion.travel);
}

}  // namespace

std::string measurement_key(const std::string& scene_key, const Scene& scene, const RowIdentity& id,
                            const Suite& suite) {
  const std::string text = fmt::format("{}|{}|{}|noise {}|sequence {}|attribution {}|baseline {}", scene_key,
                                       id.full_name(), id.receivers, suite.truth_noise, suite.sequence,
                                       suite.attribution, suite.baseline ? suite.baseline->label() : "none");
  ContentHash hash;
  hash.add(text);
  add_motion(hash, scene.motion);
  for (const Entity& entity : scene.entities)
    if (entity.motion.kind != Motion::Kind::none) add_motion(hash, entity.motion);
  return hash.digest();
}

}  // namespace penumbra
