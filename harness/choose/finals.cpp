#include "harness/choose/finals.h"

#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "harness/measure/interrupt.h"
#include "harness/measure/timing.h"
#include "harness/results/statistics.h"
#include "scenes/error.h"

namespace penumbra {
namespace {

constexpr double near = 1.3;  // looks are rough
constexpr std::size_t most_of_one = 3;

/// What is to be small among those within the bound.
double wanted(const Trial& t, const Bound& bound) {
  return bound.kind == Bound::Kind::error ? t.look.ms : t.look.error.value_or(INFINITY);
}
double wanted(const Option& o, const Bound& bound) {
  return bound.kind == Bound::Kind::error ? o.row.timing.median_frame_ms()
                                          : o.row.score.truth_error().value_or(INFINITY);
}

/// How far beyond the bound.
double distance(const Trial& t, const Bound& bound) {
  return bound.kind == Bound::Kind::error ? t.look.error.value_or(INFINITY) : t.look.ms;
}
double distance(const Option& o, const Bound& bound) {
  return bound.kind == Bound::Kind::error ? o.row.score.truth_error().value_or(INFINITY)
                                          : o.row.timing.median_frame_ms();
}

bool within(const Row& row, const Bound& bound) {
  const Look look{row.timing.median_frame_ms(), row.score.truth_error(), row.score.errors.at("truth").tie()};
  return look.within(bound);
}

/// Median of three frames in which the mesh twists; one if that takes long.
double moving_ms(Technique& technique, const Scene& scene, int threads) {
  Scene moving = scene;
  moving.motion = twist;
  Animation animation(moving);
  std::vector<vec3> image(std::size_t(scene.receivers.size()));
  std::vector<double> samples;
  const std::unique_ptr<Clock> clock = technique.make_clock();
  for (int frame = 1; frame <= 3 && (samples.empty() || samples[0] < 200.0); ++frame) {
    const Frame at = animation.frame(frame);
    tbb::task_arena(threads).execute([&] {
      clock->start();
      technique.update(at);
      technique.shade({image.data(), scene.receivers.width, scene.receivers.height});
      samples.push_back(clock->lap());
    });
  }
  return median(samples);
}

}  // namespace

std::vector<const Trial*> finalists(const std::vector<std::unique_ptr<Trial>>& trials, const Bound& bound) {
  std::map<std::string, std::vector<const Trial*>> by_entry;
  for (const auto& t : trials) by_entry[t->variant.entry->title()].push_back(t.get());
  std::vector<const Trial*> chosen;
  for (auto& [title, own] : by_entry) {
    const auto inside =
        std::stable_partition(own.begin(), own.end(), [&](const Trial* t) { return t->look.within(bound); });
    std::stable_sort(own.begin(), inside,
                     [&](const Trial* a, const Trial* b) { return wanted(*a, bound) < wanted(*b, bound); });
    if (inside == own.begin()) {
      chosen.push_back(*std::min_element(own.begin(), own.end(), [&](const Trial* a, const Trial* b) {
        return distance(*a, bound) < distance(*b, bound);
      }));
      continue;
    }
    const double best = wanted(*own.front(), bound);
    for (auto t = own.begin(); t != inside && std::size_t(t - own.begin()) < most_of_one; ++t)
      if (wanted(**t, bound) <= near * best) chosen.push_back(*t);
  }
  return chosen;
}

std::string label_of(const Variant& variant, const Row& row) {
  std::string label = variant.entry->name;
  if (variant.entry->backend == Backend::cuda) label += " (cuda)";
  if (row.id.reads_spheres) label += fmt::format(" {} spheres", row.id.spheres);
  for (const Knob& knob : variant.entry->knobs) {
    const ParameterValue& value = variant.parameters.all().at(knob.parameter);
    const auto usual = row.id.defaults.find(knob.parameter);
    if (knob.fine || usual == row.id.defaults.end() || usual->second != value)
      label += fmt::format(" {}={}", knob.parameter, to_string(value));
  }
  return label;
}

std::vector<ErrorPart> parts_of(const Trial& trial, const Trials& trials) {
  const Entry& entry = *trial.variant.entry;
  const std::string own = entry.errs_by.empty() ? "its own" : entry.errs_by;
  const bool texels = trial.variant.parameters.all().contains("resolution"), spheres = trial.row.id.reads_spheres;
  std::vector<ErrorPart> parts;
  const auto add = [&](const std::string& name, const std::optional<double>& error) {
    if (error) parts.push_back({name, *error});
  };
  if (!texels && !spheres) {  // nothing stands between the truth and what it errs by
    add(own, trial.row.score.truth_error());
    return parts;
  }
  const Score score = trials.anatomy(trial.variant, trial.spheres);
  if (texels) add("texels", trials.texel_error(trial.spheres, resolution_of(trial.variant.parameters)));
  if (spheres) add("spheres", score.geometry);
  if (const auto at = score.errors.find(spheres ? "spheres" : "cube"); at != score.errors.end())
    add(own, at->second.report.all.rel_rmse);
  std::stable_sort(parts.begin(), parts.end(),
                   [](const ErrorPart& a, const ErrorPart& b) { return a.rel_rmse > b.rel_rmse; });
  return parts;
}

std::vector<Option> timed(const std::vector<const Trial*>& candidates, const Trials& trials, const Registry& registry,
                          const Bound& bound, int repetitions, ResultsFolder& folder, Progress& progress) {
  std::vector<std::pair<const Trial*, Checked>> checked;
  for (const Trial* t : candidates) {
    stop_if_interrupted();
    progress.step("checking " + label_of(t->variant, t->row));
    Checked c = check(t->variant, trials.context(t->spheres), trials.suite(), registry, "");
    if (!c.row.ok()) progress.note(label_of(t->variant, t->row) + ": " + c.row.status), folder.add(c.row);
    else checked.emplace_back(t, std::move(c));
  }
  std::vector<TimedItem> items;
  items.reserve(checked.size());
  for (auto& [t, c] : checked)
    items.push_back({c.row.id.name(), c.technique.get(), &trials.context(t->spheres).scene(), c.row.id.threads,
                     c.estimate_ms(), c.row.timing, ""});
  progress.expect("time", int(items.size()) * repetitions, 0.05);
  {
    const Progress::Still still(progress);
    time_items(
        items, repetitions,
        {[&] { progress.step(fmt::format("timing {} candidates", items.size()), "time"); }, [](const TimedItem&) {}});
  }
  stop_if_interrupted();
  std::vector<Option> options;
  for (std::size_t k = 0; k < items.size(); ++k) {
    auto& [t, c] = checked[k];
    c.row.timing = items[k].timing;
    if (!items[k].failure.empty()) c.row.status = "failed: " + items[k].failure;
    folder.add(c.row);
    if (!c.row.ok()) continue;
    progress.step("where the error of " + label_of(t->variant, t->row) + " comes from");
    const Scene& scene = trials.context(t->spheres).scene();
    Option option{c.row, label_of(t->variant, t->row), within(c.row, bound), -1.0, parts_of(*t, trials)};
    if (!scene.mesh.empty() && !Animation(scene).deforms())
      option.moving_ms = std::max(moving_ms(*c.technique, scene, c.row.id.threads), c.row.timing.median_frame_ms());
    c.technique.reset();
    options.push_back(std::move(option));
  }
  return options;
}

std::vector<Option> best_of_each(std::vector<Option> options, const Bound& bound) {
  std::stable_sort(options.begin(), options.end(), [&](const Option& a, const Option& b) {
    if (a.within != b.within) return a.within;
    return a.within ? wanted(a, bound) < wanted(b, bound) : distance(a, bound) < distance(b, bound);
  });
  std::vector<Option> best;
  for (Option& o : options)
    if (std::none_of(best.begin(), best.end(), [&](const Option& other) {
          return other.row.id.technique == o.row.id.technique && other.row.id.backend == o.row.id.backend;
        }))
      best.push_back(std::move(o));
  return best;
}

}  // namespace penumbra
