#include "harness/measure/scene_context.h"

#include <fmt/format.h>
#include <tbb/task_arena.h>

#include <cmath>

#include "harness/measure/black_truth.h"
#include "harness/measure/chosen_frame.h"
#include "harness/measure/steps.h"
#include "harness/results/statistics.h"
#include "scenes/unsupported.h"

namespace penumbra {

namespace {

ReferenceSettings settings_of(const Suite& suite) {
  ReferenceSettings settings;
  settings.truth_noise = suite.truth_noise;
  return settings;
}

}  // namespace

std::string truth_key(const Scene& scene, const Suite& suite) {
  Animation animation(scene);
  return reference_key(animation.frame(scored_frame(animation)), Rung::truth, settings_of(suite));
}

SceneContext::SceneContext(Scene scene, const Suite& suite, std::optional<int> frame)
    : scene_(std::move(scene)),
      settings_(settings_of(suite)),
      animation_(scene_),
      frame_(animation_.frame(chosen_frame(animation_, frame))),
      valid_(valid_receivers(frame_.receivers)),
      light_(light_scale(frame_.light, frame_.receivers)),
      black_(black_level(frame_.light, frame_.receivers)) {
  key_ = reference_key(frame_, Rung::truth, settings_);
  if (!scene_.spheres.empty()) key_ += "-" + reference_key(frame_, Rung::spheres, settings_);
}

std::string SceneContext::folder() const {
  return fmt::format("{}-{}-spheres{}{}", scene_.name, scene_.spheres.size(), scene_.objective.empty() ? "" : "-",
                     scene_.objective);
}

void SceneContext::add_reference(Rung rung, int resolution, const ReferenceProgress& progress) {
  settings_.resolution = resolution ? resolution : settings_.resolution;
  Reference reference = cached_reference(frame_, rung, settings_, progress);
  if (rung == Rung::truth) {
    regions_ = classify(reference.mean.pixels, reference.unshadowed.pixels, valid_);
    open_light_ = rms(reference.unshadowed, valid_) > black_;
    exposure_ = exposure_for(reference.mean, valid_, light_);
  }
  const double noise = reference.noise(valid_);
  references_.insert_or_assign({rung, resolution}, Known{std::move(reference.mean), noise});
}

void SceneContext::add_baseline(const Variant& variant) {
  if (!variant.entry->lights.accepts(scene_.light)) throw Unsupported("it cannot shade the light");
  const Receivers& r = scene_.receivers;
  Image image{r.width, r.height, std::vector<vec3>(std::size_t(r.size()))};
  const auto technique = make_technique(*variant.entry, variant.parameters, scene_.light);
  tbb::task_arena(variant.threads).execute([&] {
    technique->prepare(scene_);
    technique->update(frame_);
    technique->shade({image.pixels.data(), r.width, r.height});
  });
  baseline_.emplace(variant.entry->name, std::move(image));
}

void SceneContext::add_sequence(Progress& progress) {
  sequence_.emplace(scene_, settings_, [&](double share) { progress.share(share); });
}

const Image* SceneContext::rung(Rung rung, int resolution) const {
  const auto at = references_.find({rung, resolution});
  return at == references_.end() ? nullptr : &at->second.mean;
}

/// An occluder in millimetres over a plane in metres is easily made and hard to see.
void SceneContext::warn_of_sizes(Progress& progress) const {
  if (scene_.mesh.empty()) return;
  Bounds box{vec3(INFINITY), vec3(-INFINITY)};
  for (int i = 0; i < frame_.receivers.size(); ++i)
    if (valid_[i])
      box = {glm::min(box.low, frame_.receivers.position[i]), glm::max(box.high, frame_.receivers.position[i])};
  const float mesh = glm::length(bounds(frame_.mesh).extent()), lit = glm::length(box.extent());
  constexpr float much = 8.0f;
  if (lit > 0.0f && mesh > much * lit)
    progress.note_once(fmt::format(
        "{}: the mesh is {:.3g} m across, its receivers {:.3g} m: most of what they could show is outside; is the "
        "mesh in another unit? (`fit = {{ height = ... }}` scales it)",
        scene_.name, mesh, lit));
}

void SceneContext::warn_of_spheres(Progress& progress) const {
  constexpr double much = 0.2;
  for (const auto& [which, known] : references_) {
    const Image* cube = which.first == Rung::spheres ? rung(Rung::cube, which.second) : nullptr;
    if (!cube) continue;
    const auto error = relative(rms(difference(known.mean, *cube), valid_), rms(*cube, valid_), black_);
    if (error && *error > much)
      progress.note_once(fmt::format(
          "{}: its {} spheres miss the mesh: they alone put {:.0f} % of error into whatever shades with them; ask for "
          "more, or look at the fit (`penumbra fit`)",
          scene_.name, scene_.spheres.size(), 100.0 * *error));
  }
}

std::optional<double> SceneContext::error_of(Rung which, int resolution) const {
  const Image* image = rung(which, resolution);
  if (!image) return {};
  return relative(rms(difference(*image, truth()), valid_), rms(truth(), valid_), black_);
}

std::string SceneContext::blackness() const {
  return rms(truth(), valid_) > black_ ? "" : black_note(scene_.name, frame_.light, frame_.receivers, open_light_);
}

void SceneContext::finish_references(Progress& progress) {
  if (const std::string why = blackness(); !why.empty()) progress.note_once(why);
  warn_of_sizes(progress);
  warn_of_spheres(progress);
}

Score SceneContext::score(const Image& image, const Parameters& parameters) const {
  Score score;
  const int n = resolution_of(parameters);
  for (const auto& [which, known] : references_) {
    if (which.second != 0 && which.second != n) continue;
    RungErrors& errors = score.errors[to_string(which.first)];
    errors.report = compare_images(image, known.mean, regions_, valid_, exposure_, black_);
    errors.noise = known.noise;
    errors.rel_noise = relative(errors.noise, rms(known.mean, valid_), black_);
  }
  if (baseline_)
    score.errors[baseline_->first].report =
        compare_images(image, baseline_->second, regions_, valid_, exposure_, black_);
  const Image *cube = rung(Rung::cube, n), *spheres = rung(Rung::spheres, n);
  if (cube && spheres) score.geometry = relative(rms(difference(*spheres, *cube), valid_), rms(*cube, valid_), black_);
  return score;
}

std::optional<SequenceErrors> SceneContext::score_sequence(Technique& technique, const std::string& sheet_file) const {
  if (!sequence_) return {};
  return sequence_->score(technique, exposure_, sheet_file);
}

std::vector<StepError> SceneContext::attribute(const Technique& technique, const Image& image,
                                               const Parameters& parameters) const {
  const Image* spheres = rung(Rung::spheres, resolution_of(parameters));
  if (!spheres || !(rms(*spheres, valid_) > black_)) return {};
  return attribute_error(technique.approximations(), *spheres, image, valid_);
}

double SceneContext::view_ms(int threads) const {
  if (!std::holds_alternative<Camera>(scene_.receiver_spec.kind)) return -1.0;
  const auto [at, fresh] = view_ms_.try_emplace(threads, 0.0);
  if (!fresh) return at->second;
  std::vector<double> samples;
  SteadyClock clock;
  for (int k = 0; k < 3; ++k)
    tbb::task_arena(threads).execute([&] {
      clock.start();
      make_receivers(animation_.receiver_spec(int(frame_.time)), frame_.mesh);
      samples.push_back(clock.lap());
    });
  return at->second = median(samples);
}

}  // namespace penumbra
