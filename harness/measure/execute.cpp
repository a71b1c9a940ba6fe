#include "harness/measure/execute.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "harness/measure/check.h"
#include "harness/measure/interrupt.h"
#include "harness/measure/run_external.h"
#include "harness/measure/scene_images.h"
#include "harness/measure/steps_left.h"
#include "harness/measure/timing.h"

namespace penumbra {
namespace {

/// The jobs of one scene.
class SceneJobs {
 public:
  /// `later`: steps of the scenes behind this one.
  SceneJobs(const Plan& plan, const PlannedScene& planned, const Registry& registry, ResultsFolder& folder,
            Progress& progress, StepCounts later)
      : plan_(plan),
        planned_(planned),
        registry_(registry),
        folder_(folder),
        progress_(progress),
        later_(std::move(later)),
        context_(load_scene(planned.listed, planned.choice,
                            [&](const std::string& stage, double share) { progress.share(stage, share); }),
                 *plan.suite),
        images_(*plan.suite, folder.directory(), context_) {}

  const SceneContext& context() const { return context_; }
  const SceneImages& images() const { return images_; }

  /// Takes over what is finished, and what cannot be measured; false if nothing else is left.
  bool take_over(const std::vector<Row>& earlier, std::size_t& kept) {
    std::vector<std::string> names;
    for (const Job& job : planned_.jobs) {
      if (job.kind != Job::Kind::measurement) continue;
      const Row row = empty_row(variant(job), context_, *plan_.suite);
      names.push_back(row.id.name());
      const auto at = std::find_if(earlier.begin(), earlier.end(), [&](const Row& old) {
        return old.id.name() == row.id.name() && may_stand_for(old, row);
      });
      if (!row.ok()) folder_.add(row);
      else if (at == earlier.end()) todo_.insert(job.variant);
      else folder_.add(*at), ++kept;
    }
    folder_.expect(names);
    return !todo_.empty();
  }

  void run() {
    announce_jobs();
    for (const Job& job : planned_.jobs) {
      stop_if_interrupted();
      do_job(job);
    }
    time_checked();
  }

  /// All that is not finished has failed.
  void fail(const std::string& why) {
    for (const std::size_t k : todo_) {
      Row row = empty_row(plan_.suite->variants[k], context_, *plan_.suite);
      row.status = "failed: " + why;
      folder_.add(row);
    }
  }

 private:
  /// Is what was measured then what would be measured now?
  bool may_stand_for(const Row& old, const Row& now) const {
    const std::size_t samples = old.timing.frame_ms.size();
    const bool whole =
        now.id.external() || (samples >= std::size_t(plan_.repetitions) && old.timing.update_ms.size() == samples &&
                              old.timing.shade_ms.size() == samples);
    return old.ok() && old.facts.key == now.facts.key && whole;
  }

  const Variant& variant(const Job& job) const { return plan_.suite->variants[job.variant]; }

  void announce_jobs() {
    StepCounts left;
    for (const Job& job : planned_.jobs)
      if (job.kind == Job::Kind::measurement ? todo_.contains(job.variant) : asked_for(job.resolution))
        ++left[step_kind(job.kind)];
    left["fit"] = 0;
    left["time"] = left["check"] * plan_.repetitions;
    announce(sum(left, later_), progress_);
  }

  /// "bunny-city: truth"
  void begin(const Job& job, const std::string& what) {
    progress_.step(context_.scene().name + ": " + what, step_kind(job.kind));
  }

  void do_job(const Job& job) {
    switch (job.kind) {
      case Job::Kind::fit:  // came with the scene
        return;
      case Job::Kind::reference:
        if (!asked_for(job.resolution)) return;
        begin(job, to_string(job.rung));
        if (inapplicable(context_.frame(), job.rung).empty())
          context_.add_reference(job.rung, job.resolution, [&](double share) { progress_.share(share); });
        return;
      case Job::Kind::baseline:
        return add_baseline(job);
      case Job::Kind::sequence:
        begin(job, "truths of all frames");
        return context_.add_sequence(progress_);
      case Job::Kind::measurement:
        if (todo_.contains(job.variant)) check_variant(job);
    }
  }

  /// Does a row that is left to do compare itself with rungs of this resolution?
  bool asked_for(int resolution) const {
    return resolution == 0 || std::any_of(todo_.begin(), todo_.end(), [&](std::size_t k) {
             return resolution_of(plan_.suite->variants[k].parameters) == resolution;
           });
  }

  void add_baseline(const Job& job) {
    const Variant& baseline = *plan_.suite->baseline;
    begin(job, "baseline " + baseline.label());
    try {
      context_.add_baseline(baseline);
    } catch (const std::exception& e) {
      progress_.note(fmt::format("{}: no baseline {}: {}", context_.scene().name, baseline.entry->title(), e.what()));
    }
  }

  void check_variant(const Job& job) {
    folder_.save_if_due();
    if (!ready_) {
      context_.finish_references(progress_);
      images_.save_truth();
      ready_ = true;
    }
    const Variant& v = variant(job);
    begin(job, (v.external ? "running " : "checking ") + v.label());
    Checked c = v.external ? check_external(v, context_, *plan_.suite, exported_)
                           : check(v, context_, *plan_.suite, registry_, images_.sheet_file(v));
    if (c.row.failed()) progress_.note(c.row.id.name() + ": " + c.row.status);
    if (!c.row.ok()) return finish(job.variant, c.row);
    images_.save(v, c.image);
    c.row.facts.image = images_.stem(v);
    if (v.external) return finish(job.variant, c.row);
    c.image = {};
    checked_.emplace_back(job.variant, std::move(c));
  }

  void finish(std::size_t variant, const Row& row) {
    folder_.add(row);
    todo_.erase(variant);
  }

  void time_checked() {
    announce(sum({{"time", int(checked_.size()) * plan_.repetitions}}, later_), progress_);
    const Progress::Still still(progress_);
    std::vector<TimedItem> items;
    for (const auto& [variant, c] : checked_)
      items.push_back(
          {c.row.id.name(), c.technique.get(), &context_.scene(), c.row.id.threads, c.estimate_ms(), c.row.timing, ""});
    const auto finished = [&](const TimedItem& item) {
      auto& [variant, c] = checked_[std::size_t(&item - items.data())];
      c.row.timing = item.timing;
      if (!item.failure.empty()) c.row.status = "failed: " + item.failure;
      finish(variant, c.row);
    };
    time_items(items, plan_.repetitions,
               {[&] {
                  if (interrupted()) return;
                  progress_.step(fmt::format("{}: timing {} rows", context_.scene().name, items.size()), "time");
                  folder_.save_if_due();
                },
                finished});
  }

  const Plan& plan_;
  const PlannedScene& planned_;
  const Registry& registry_;
  ResultsFolder& folder_;
  Progress& progress_;
  const StepCounts later_;
  SceneContext context_;
  SceneImages images_;
  std::optional<ExportedScene> exported_;                 ///< for external techniques
  bool ready_ = false;                                    ///< are all references there?
  std::set<std::size_t> todo_;                            ///< variants that have no row yet
  std::vector<std::pair<std::size_t, Checked>> checked_;  ///< with their variants
};

/// Rows of a scene that could not even be loaded.
void fail_scene(const Plan& plan, const PlannedScene& scene, const std::string& why, ResultsFolder& folder) {
  for (const Job& job : scene.jobs) {
    if (job.kind != Job::Kind::measurement) continue;
    Row row;
    row.id = identity_of(scene.outline, plan.suite->variants[job.variant]);
    row.status = "failed: " + why;
    folder.expect({row.id.name()});
    folder.add(row);
  }
}

/// Runs one scene unless another with as many fitted spheres had its turn. What is thrown for the scene as a whole is
/// the failure of its rows.
void run_scene(const Plan& plan, const PlannedScene& planned, const Registry& registry, const std::vector<Row>& earlier,
               ResultsFolder& folder, Progress& progress, const StepCounts& later, std::set<std::string>& seen,
               std::size_t& kept, const SceneDone& scene_done) {
  std::optional<SceneJobs> jobs;
  try {
    announce(sum(steps_of(planned, plan.repetitions), later), progress);
    progress.step(planned.outline.name + ": loading", step_kind(Job::Kind::fit));
    jobs.emplace(plan, planned, registry, folder, progress, later);
    if (!seen.insert(jobs->context().folder()).second)
      return progress.note(fmt::format("{}: a fit of {} spheres needs no more than {}, which had their turn",
                                       planned.outline.name, planned.outline.spheres,
                                       jobs->context().scene().spheres.size()));
    const bool changed = jobs->take_over(earlier, kept);
    if (changed) jobs->run();
    if (!interrupted()) scene_done(jobs->images().folder(), changed);
  } catch (const std::exception& e) {
    stop_if_interrupted();  // it may have taken a child process along
    progress.note(fmt::format("scene {}: failed: {}", planned.outline.name, e.what()));
    if (jobs) jobs->fail(e.what());
    else fail_scene(plan, planned, e.what(), folder);
  }
}

}  // namespace

std::map<std::string, std::string> check_scenes(const Plan& plan) {
  std::map<std::string, std::string> keys;
  Progress progress;
  for (const PlannedScene& scene : plan.scenes) {
    if (keys.contains(scene.outline.name)) continue;
    progress.step("looking at " + scene.outline.name);
    keys[scene.outline.name] =
        truth_key(load_scene(scene.listed, {scene.choice.count, scene.choice.objective, false}), *plan.suite);
  }
  return keys;
}

std::size_t execute(const Plan& plan, const Registry& registry, const std::vector<Row>& earlier, ResultsFolder& folder,
                    const SceneDone& scene_done) {
  Progress progress;
  StepCounts later;
  for (const PlannedScene& scene : plan.scenes) later = sum(later, steps_of(scene, plan.repetitions));
  std::set<std::string> seen;
  std::size_t kept = 0;
  try {
    for (const PlannedScene& scene : plan.scenes) {
      stop_if_interrupted();
      for (const auto& [kind, count] : steps_of(scene, plan.repetitions)) later[kind] -= count;
      run_scene(plan, scene, registry, earlier, folder, progress, later, seen, kept, scene_done);
      if (const std::string why = folder.save(); !why.empty())
        progress.note(why + "; going on, the tables come at the end");
    }
  } catch (const Interrupted&) {  // what is finished is in the folder
  }
  return kept;
}

}  // namespace penumbra
