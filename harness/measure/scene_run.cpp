#include "harness/measure/scene_run.h"

#include <fmt/format.h>
#include <tbb/task_arena.h>

#include <chrono>
#include <cmath>
#include <set>

#include "harness/commands/run.h"
#include "harness/measure/black_truth.h"
#include "harness/measure/file_stems.h"
#include "harness/measure/interrupt.h"
#include "harness/measure/steps.h"
#include "harness/results/pictures.h"
#include "scenes/error.h"

namespace penumbra {
namespace {

double milliseconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

}  // namespace

int resolution_of(const Parameters& parameters) {
  const auto at = parameters.all().find("resolution");
  return at == parameters.all().end() ? 32 : std::get<int>(at->second);
}

SceneRun::SceneRun(const Scene& scene, const Registry& registry, const Suite& suite, std::string image_directory)
    : scene_(scene),
      registry_(registry),
      attribution_(suite.attribution),
      stems_(file_stems(suite.variants)),
      image_directory_(std::move(image_directory)),
      animation_(scene),
      frame_(animation_.frame(animation_.frames() / 3)),
      valid_(valid_receivers(frame_.receivers)),
      light_(light_scale(frame_.light, frame_.receivers)),
      black_(black_level(frame_.light, frame_.receivers)) {
  settings_.truth_noise = suite.truth_noise;
  key_ = reference_key(frame_, Rung::truth, settings_);
  if (!scene.spheres.empty()) key_ += "-" + reference_key(frame_, Rung::spheres, settings_);
}

Row row_of(const Scene& scene, const Variant& variant) {
  Row row;
  row.scene = scene.name;
  row.spheres = scene.spheres.size();
  row.objective = scene.objective;
  row.receivers = std::size_t(scene.receivers.size());
  row.technique = variant.entry->name;
  row.backend = variant.entry->backend;
  row.parameters = variant.parameters;
  row.threads = variant.threads;
  return row;
}

Row SceneRun::empty_row(const Variant& variant) const {
  Row row = row_of(scene_, variant);
  row.scene_key = key_;
  return row;
}

void SceneRun::make_sequence(Progress& progress) {
  sequence_.emplace(scene_, settings_, [&](int frame) {
    progress.share(fmt::format("{}: truths of {} frames", scene_.name, animation_.frames()),
                   double(frame) / animation_.frames());
  });
}

void SceneRun::make_references(const std::vector<Variant>& variants, Progress& progress) {
  progress.step(scene_.name + ": references");
  std::set<int> resolutions;
  for (const Variant& v : variants) resolutions.insert(resolution_of(v.parameters));
  for (const Rung rung : {Rung::truth, Rung::r13x13, Rung::cube, Rung::spheres}) {
    if (!inapplicable(frame_, rung).empty()) continue;
    const bool texels = rung == Rung::cube || rung == Rung::spheres;
    for (const int n : texels ? resolutions : std::set<int>{0}) {
      if (interrupted()) return;
      settings_.resolution = n;
      references_[{rung, n}] = cached_reference(frame_, rung, settings_);
    }
  }
  if (!(rms(truth().mean, valid_) > black_))
    progress.note_once(
        black_note(scene_.name, frame_.light, frame_.receivers, rms(truth().unshadowed, valid_) > black_));
  exposure_ = exposure_for(truth().mean, valid_, light_);
  regions_ = classify(truth().mean.pixels, truth().unshadowed.pixels, valid_);
  write_images("truth", truth().mean);
}

void SceneRun::make_baseline(const Variant& variant, Progress& progress) {
  progress.step(scene_.name + ": baseline");
  const Receivers& r = scene_.receivers;
  Reference reference;
  reference.mean = {r.width, r.height, std::vector<vec3>(std::size_t(r.size()))};
  reference.variance = {r.width, r.height, std::vector<vec3>(std::size_t(r.size()), vec3(0.0f))};
  try {
    if (!variant.entry->lights.accepts(scene_.light)) throw Unsupported("it cannot shade the light");
    const auto technique = make_technique(*variant.entry, variant.parameters);
    tbb::task_arena(variant.threads).execute([&] {
      technique->prepare(scene_);
      technique->update(frame_);
      technique->shade({reference.mean.pixels.data(), r.width, r.height});
    });
    baseline_.emplace(variant.entry->name, std::move(reference));
  } catch (const std::exception& e) {
    progress.note(fmt::format("{}: no baseline {}: {}", scene_.name, variant.entry->title(), e.what()));
  }
}

/// Median of three runs of the camera's rays; -1 without a camera.
double SceneRun::view_ms(int threads) const {
  if (!std::holds_alternative<Camera>(scene_.receiver_spec.kind)) return -1.0;
  const auto [at, fresh] = view_ms_.try_emplace(threads, 0.0);
  if (!fresh) return at->second;
  std::vector<double> samples;
  for (int k = 0; k < 3; ++k)
    tbb::task_arena(threads).execute([&] {
      const auto start = std::chrono::steady_clock::now();
      make_receivers(scene_.receiver_spec, frame_.mesh);
      samples.push_back(milliseconds_since(start));
    });
  return at->second = median(samples);
}

void SceneRun::score(const Image& image, const Parameters& parameters, Row& row) const {
  for (const auto& [which, reference] : references_) {
    if (which.second != 0 && which.second != resolution_of(parameters)) continue;
    RungErrors& errors = row.errors[to_string(which.first)];
    errors.report = compare_images(image, reference.mean, regions_, valid_, exposure_, black_);
    errors.noise = reference.noise(valid_);
    errors.rel_noise = relative(errors.noise, rms(reference.mean, valid_), black_);
  }
  if (baseline_)
    row.errors[baseline_->first].report =
        compare_images(image, baseline_->second.mean, regions_, valid_, exposure_, black_);
  const int n = resolution_of(parameters);
  const auto cube = references_.find({Rung::cube, n}), spheres = references_.find({Rung::spheres, n});
  if (cube == references_.end() || spheres == references_.end()) return;
  row.geometry = relative(rms(difference(spheres->second.mean, cube->second.mean), valid_),
                          rms(cube->second.mean, valid_), black_);
}

void SceneRun::shade_and_score(const Variant& variant, Candidate& c) const {
  const Receivers& r = scene_.receivers;
  c.image = {r.width, r.height, std::vector<vec3>(std::size_t(r.size()), vec3(NAN))};
  tbb::task_arena(variant.threads).execute([&] {
    auto start = std::chrono::steady_clock::now();
    c.technique->prepare(scene_);
    c.row.prepare_ms = milliseconds_since(start);
    c.technique->update(frame_);
    for (int warm = 0; warm < 2; ++warm) {  // the second look is the estimate, unless the first was long enough
      start = std::chrono::steady_clock::now();
      c.technique->shade({c.image.pixels.data(), r.width, r.height});
      c.estimate_ms = milliseconds_since(start);
      if (c.estimate_ms > 100.0) break;
    }
  });
  for (std::size_t i = 0; i < c.image.pixels.size(); ++i)
    for (int k = 0; k < 3; ++k)
      if (!std::isfinite(c.image.pixels[i][k]))
        throw std::runtime_error(fmt::format("receiver {} has the radiance {}", i, c.image.pixels[i][k]));
  c.row.counters = c.technique->counters();
  c.row.instruction_set = c.technique->instruction_set();
  c.row.bytes = c.technique->footprint();
  c.row.view_ms = view_ms(variant.threads);
  if (variant.entry->backend != "scalar") {
    c.row.parity = parity_with_scalar(registry_, *variant.entry, variant.parameters, scene_);
    if (!(c.row.parity <= variant.entry->parity))
      throw std::runtime_error(fmt::format("differs from its scalar twin by {:.3g} (relative RMSE); allowed is {:.3g}",
                                           c.row.parity, variant.entry->parity));
  }
  score(c.image, variant.parameters, c.row);
  const auto spheres = references_.find({Rung::spheres, resolution_of(variant.parameters)});
  if (attribution_ && spheres != references_.end() && rms(spheres->second.mean, valid_) > black_)
    c.row.steps = attribute_error(c.technique->approximations(), spheres->second.mean, c.image, valid_);
  if (!sequence_) return;
  const std::string sheet = image_directory_ + "/" + stems_.at(variant.label()) + ".sheet.png";
  tbb::task_arena(variant.threads).execute([&] { c.row.sequence = sequence_->score(*c.technique, exposure_, sheet); });
}

SceneRun::Candidate SceneRun::check(const Variant& variant) const {
  Candidate c;
  c.row = empty_row(variant);
  const Entry& entry = *variant.entry;
  if (!entry.unavailable.empty()) {
    c.row.status = "skipped: " + entry.unavailable;
  } else if (!entry.lights.accepts(scene_.light)) {
    c.row.status =
        environment_of(scene_.light) ? "skipped: cannot shade an environment" : "skipped: cannot shade an area light";
  } else {
    try {
      c.technique = make_technique(entry, variant.parameters);
      shade_and_score(variant, c);
    } catch (const Unsupported& e) {
      c.row.status = std::string("skipped: ") + e.what();
    } catch (const std::exception& e) {
      c.row.status = std::string("failed: ") + e.what();
    }
  }
  if (!c.row.ok()) {
    c.technique.reset();
    c.row.errors.clear();
  }
  return c;
}

void SceneRun::write_images(const std::string& stem, const Image& image) const {
  const std::string base = image_directory_ + "/" + stem;
  try_to_save([&] {
    save_exr(base + ".exr", image);
    save_png(base + ".png", exposed(image, exposure_));
    if (&image != &truth().mean) save_png(base + ".error.png", signed_error(image, truth().mean, exposure_));
  });
}

void SceneRun::write_overview(const std::vector<Candidate>& candidates) const {
  constexpr std::size_t columns = 6;
  std::vector<Image> images = {exposed(truth().mean, exposure_)}, errors = {exposed(truth().mean, exposure_)};
  for (const Candidate& c : candidates)
    if (c.row.ok() && c.image.height > 1) {
      images.push_back(exposed(c.image, exposure_));
      errors.push_back(signed_error(c.image, truth().mean, exposure_));
    }
  std::vector<std::vector<Image>> rows;
  for (std::size_t k = 0; k < images.size(); k += columns)
    for (const std::vector<Image>* from : {&images, &errors})
      rows.emplace_back(from->begin() + std::ptrdiff_t(k),
                        from->begin() + std::ptrdiff_t(std::min(images.size(), k + columns)));
  if (images.size() > 1) try_to_save([&] { save_png(image_directory_ + "/overview.png", contact_sheet(rows)); });
}

std::vector<Row> SceneRun::measure(const std::vector<Variant>& variants, int repetitions, Progress& progress) {
  std::vector<Candidate> candidates;
  for (const Variant& variant : variants) {
    if (interrupted()) return {};
    progress.step(scene_.name + ": checking " + variant.label());
    candidates.push_back(check(variant));
    const Candidate& c = candidates.back();
    if (c.row.status.starts_with("failed")) progress.note(c.row.name() + ": " + c.row.status);
    if (c.row.ok()) write_images(stems_.at(variant.label()), c.image);
  }

  write_overview(candidates);

  std::vector<TimedItem> items;
  for (Candidate& c : candidates)
    if (c.row.ok())
      items.push_back({c.row.name(), c.technique.get(), c.row.threads, c.estimate_ms, 0, {}, {}, {}, {}, ""});
  time_items(items, scene_, repetitions, [&] { progress.step(scene_.name + ": timing"); });

  std::vector<Row> rows;
  auto item = items.begin();
  for (Candidate& c : candidates) {
    if (c.row.ok()) {
      TimedItem& timed = *item++;
      c.row.iterations = timed.iterations;
      c.row.update_ms = timed.update_ms, c.row.shade_ms = timed.shade_ms, c.row.frame_ms = timed.frame_ms;
      c.row.stages = std::move(timed.stages);
      if (!timed.failure.empty()) c.row.status = "failed: " + timed.failure;
      else if (int(c.row.frame_ms.size()) < repetitions) continue;  // interrupted
    }
    rows.push_back(std::move(c.row));
  }
  return rows;
}

}  // namespace penumbra
