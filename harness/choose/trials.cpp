#include "harness/choose/trials.h"

#include "harness/measure/interrupt.h"
#include "harness/measure/parity.h"
#include "scenes/error.h"

namespace penumbra {
namespace {

/// Receivers along an edge of what is looked at in detail.
constexpr int few = 32;

/// At rest receivers can be thinned; those on a mesh that moves are made anew.
Scene thinned_if_possible(const Scene& scene) {
  const bool on_plane = std::holds_alternative<PlaneGrid>(scene.receiver_spec.kind);
  return on_plane || scene.motion.kind == Motion::Kind::none ? thinned(scene, few) : scene;
}

}  // namespace

Trials::Trials(std::string scene, bool moving, double truth_noise, ResultsFolder& folder, Progress& progress)
    : scene_(std::move(scene)), moving_(moving), folder_(folder), progress_(progress) {
  suite_.name = "choose";
  suite_.truth_noise = truth_noise;
  add_context(0);
  const Scene& loaded = context(0).scene();
  may_fit_ = loaded.spheres.empty() && !loaded.mesh.empty();
}

Scene Trials::load(int spheres) {
  SphereChoice choice;
  choice.fitted = spheres > 0;
  if (spheres > 0) choice.count = spheres;
  progress_.step(spheres > 0 ? fmt::format("fitting {} spheres", spheres) : "loading " + scene_);
  Scene scene =
      load_scene(scene_, choice, [&](const std::string& stage, double share) { progress_.share(stage, share); });
  if (moving_ && !Animation(scene).deforms()) {
    if (scene.mesh.empty()) throw Error("--moving: scene {} has no mesh that could move", scene.name);
    scene.motion = twist;
  }
  return scene;
}

void Trials::add_context(int spheres) {
  Scene scene = load(spheres);
  Contexts made;
  made.few = std::make_unique<SceneContext>(thinned_if_possible(scene), suite_);
  made.whole = std::make_unique<SceneContext>(std::move(scene), suite_);
  progress_.step("truth");
  made.whole->add_reference(Rung::truth, 0, [&](double share) { progress_.share(share); });
  progress_.step("references of a few receivers");
  made.few->add_reference(Rung::truth, 0);
  for (const Rung rung : {Rung::cube, Rung::spheres})
    for (const int n : {16, 32})
      if (inapplicable(made.few->frame(), rung).empty()) made.few->add_reference(rung, n);
  contexts_.emplace(spheres, std::move(made));
}

void Trials::fit(int spheres) {
  if (!has_spheres(spheres)) add_context(spheres);
}

const Trial* Trials::look(const Variant& variant, int spheres) {
  stop_if_interrupted();
  const SceneContext& on = context(spheres);
  const std::string name = empty_row(variant, on, suite_).id.name();
  if (const auto at = by_name_.find(name); at != by_name_.end()) return at->second;
  Checked c = look_at(variant, on, suite_);
  if (!c.row.ok()) {
    refusals_.try_emplace(variant.entry->name, c.row.status.substr(c.row.status.find(": ") + 2));
    return by_name_[name] = nullptr;
  }
  c.row.timing.iterations = 1;
  c.row.timing.update_ms = {c.update_ms};
  c.row.timing.shade_ms = {c.shade_ms};
  c.row.timing.frame_ms = {c.estimate_ms()};
  folder_.expect({name});
  folder_.add(c.row);
  const bool tie = c.row.score.errors.at("truth").tie();
  const Look look{c.estimate_ms(), c.row.score.truth_error(), tie};
  all_.push_back(std::make_unique<Trial>(Trial{variant, spheres, std::move(c.row), look}));
  return by_name_[name] = all_.back().get();
}

Score Trials::anatomy(const Variant& variant, int spheres) const {
  return look_at(variant, *contexts_.at(spheres).few, suite_).row.score;
}

std::optional<double> Trials::texel_error(int spheres, int resolution) const {
  return contexts_.at(spheres).few->error_of(Rung::cube, resolution);
}

std::optional<double> Trials::sphere_error(int spheres) const {
  return contexts_.at(spheres).few->error_of(Rung::spheres, few);
}

}  // namespace penumbra
