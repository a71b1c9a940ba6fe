#include "harness/choose/choose.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <set>

#include "harness/choose/finals.h"
#include "harness/choose/sphere_ladder.h"
#include "harness/measure/interrupt.h"
#include "scenes/error.h"

namespace penumbra {
namespace {

double seconds_now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

class Chooser {
 public:
  Chooser(const ChooseSettings& settings, const Registry& registry, ResultsFolder& folder, Progress& progress)
      : settings_(settings),
        bound_(settings.bound),
        registry_(registry),
        folder_(folder),
        progress_(progress),
        start_(seconds_now()),
        trials_(settings.scene, settings.moving, truth_noise(), folder, progress) {
    if (const std::string black = trials_.context(0).blackness(); !black.empty()) throw Error("{}", black);
  }

  Answer run() {
    for (const Entry* entry : contenders(registry_))
      for (const Line& line : lines_of(*entry)) (line.reads_spheres() ? on_spheres_ : on_mesh_).push_back(line);
    begin_ = seconds_now();
    for (const Line& line : on_mesh_) explore(line, 0);
    climb_spheres();
    const std::vector<const Trial*> found = finalists(trials_.all(), bound_);
    if (settings_.exhaustive) look_everywhere();
    return answer(found);
  }

 private:
  /// Small beside the bound, and no smaller than it need be.
  double truth_noise() const {
    const double tenth = bound_.kind == Bound::Kind::error ? 0.125 * bound_.value : 0.002;
    return std::clamp(tenth, 0.0005, 0.005);
  }

  double seconds() const { return seconds_now() - start_; }

  Variant variant(const Line& line, int value) const {
    return {line.entry, line.at(value), line.entry->backend == Backend::scalar ? 1 : settings_.threads};
  }

  /// The best so far, of all or of one technique: least time within the error, or least error within the time.
  std::optional<double> best(const Entry* of = nullptr) const {
    std::optional<double> best;
    for (const auto& t : trials_.all()) {
      if (!t->look.within(bound_) || (of && of != t->variant.entry)) continue;
      const double value = bound_.kind == Bound::Kind::error ? t->look.ms : t->look.error.value_or(INFINITY);
      if (!best || value < *best) best = value;
    }
    return best;
  }

  std::optional<Look> look(const Line& line, int spheres, int value) {
    const Variant v = variant(line, value);
    progress_.step(fmt::format("trying {}{}", spheres ? fmt::format("{} spheres, ", spheres) : "", v.label()));
    const Trial* trial = trials_.look(v, spheres);
    return trial ? std::optional(trial->look) : std::nullopt;
  }

  void explore(const Line& line, int spheres) {
    const LookAt look_at = [&](int value) { return look(line, spheres, value); };
    if (bound_.kind == Bound::Kind::time) {
      best_on(line, bound_, look_at);
      return;
    }
    // A line that is three times slower than the best and not there yet will not win, nor will one that is three times
    // slower than another of its technique.
    const auto times = [](const std::optional<double>& ms) { return 3.0 * ms.value_or(INFINITY); };
    best_on(line, bound_, look_at, {times(best()), times(best(line.entry))});
  }

  /// The grid that the search is measured by.
  void look_everywhere() {
    const auto look_along = [&](const Line& line, int spheres) {
      if (line.knob.empty()) look(line, spheres, 0);
      for (const int value : line.values) look(line, spheres, value);
    };
    for (const Line& line : on_mesh_) look_along(line, 0);
    for (const int n : {8, 16, 32, 64, 128, 256}) {
      if (on_spheres_.empty() || !trials_.may_fit()) return;
      trials_.fit(n);
      for (const Line& line : on_spheres_) look_along(line, n);
    }
  }

  void climb_spheres() {
    if (on_spheres_.empty()) return;
    if (trials_.has_spheres(0) && !trials_.context(0).scene().spheres.empty()) {
      for (const Line& line : on_spheres_) explore(line, 0);
      return;
    }
    if (!trials_.may_fit()) return refuse("the scene has neither spheres nor a mesh to fit them to");
    SphereLadder ladder;
    double per_sphere = 0.0;  // s, of the slowest fit so far
    for (std::optional<int> n = ladder.next(bound_, best()); n; n = ladder.next(bound_, best())) {
      ladder.close(*n);
      const double expected = per_sphere * std::pow(double(*n), 1.5);
      if (seconds_now() - begin_ + expected > settings_.patience) {
        left_out_.push_back(
            per_sphere > 0.0 ? fmt::format("{} spheres, whose fit would take about {:.0f} s (--patience)", *n, expected)
                             : fmt::format("{} spheres, no time being left (--patience)", *n));
        continue;
      }
      const double begin = seconds();
      try {
        trials_.fit(*n);
      } catch (const Error& e) {
        return refuse(fmt::format("no spheres can be fitted: {}", e.what()));
      }
      per_sphere = std::max(per_sphere, (seconds() - begin) / std::pow(double(*n), 1.5));
      for (const Line& line : on_spheres_) explore(line, *n);
      tell(ladder, *n);
    }
  }

  void tell(SphereLadder& ladder, int spheres) const {
    const std::optional<double> geometry = trials_.sphere_error(spheres);
    for (const auto& t : trials_.all())
      if (t->spheres == spheres && t->look.error && geometry)
        ladder.add({t->variant.entry->title(), spheres, t->look.ms, *t->look.error, *geometry});
  }

  void refuse(const std::string& why) {
    for (const Line& line : on_spheres_) refusals_.try_emplace(line.entry->name, why);
  }

  /// Techniques that were never shaded with, by reason.
  std::vector<Impossible> impossible() const {
    std::set<std::string> shaded;
    for (const auto& t : trials_.all()) shaded.insert(t->variant.entry->name);
    std::map<std::string, std::string> all = trials_.refusals();
    all.insert(refusals_.begin(), refusals_.end());
    std::vector<Impossible> list;
    for (const auto& [technique, reason] : all) {
      if (shaded.contains(technique)) continue;
      const auto same = [&, &why = reason](const Impossible& i) { return i.reason == why; };
      auto at = std::find_if(list.begin(), list.end(), same);
      if (at == list.end()) at = list.insert(at, {reason, {}});
      at->techniques.push_back(technique);
    }
    return list;
  }

  /// What the search found, and of a grid whatever may be the best.
  std::vector<const Trial*> candidates(std::vector<const Trial*> found) const {
    if (!settings_.exhaustive) return found;
    for (const auto& t : trials_.all()) {
      const bool rival = t->look.within(bound_) &&
                         (bound_.kind == Bound::Kind::time ? t->look.error.value_or(INFINITY) <= 1.3 * *best()
                                                           : t->look.ms <= 1.5 * *best());
      if (rival && std::find(found.begin(), found.end(), t.get()) == found.end()) found.push_back(t.get());
    }
    return found;
  }

  Answer answer(const std::vector<const Trial*>& found) {
    const SceneContext& base = trials_.context(0);
    Answer a;
    a.bound = bound_;
    a.scene = base.scene().name;
    a.scene_file = settings_.scene, a.folder = folder_.directory();
    a.moving = Animation(base.scene()).deforms();
    a.receivers = std::size_t(base.scene().receivers.size());
    a.threads = settings_.threads;
    std::vector<Option> options = measured(candidates(found));
    if (bound_.kind == Bound::Kind::time) step_down(options);
    if (settings_.exhaustive) a.searched = searched(options, found);
    a.options = best_of_each(std::move(options), bound_);
    if (!a.options.empty()) a.rel_noise = a.options.front().row.score.errors.at("truth").rel_noise;
    a.impossible = impossible();
    a.left_out = left_out_;
    a.truth_noise = truth_noise();
    a.looks = int(trials_.all().size());
    a.seconds = seconds();
    return a;
  }

  std::vector<Option> measured(const std::vector<const Trial*>& candidates) {
    return timed(candidates, trials_, registry_, bound_, settings_.repetitions, folder_, progress_);
  }

  /// One look may have promised a time that the repetitions do not keep: techniques of which nothing is within it get a
  /// second chance with their fine knob turned down by as much.
  void step_down(std::vector<Option>& options) {
    std::vector<const Trial*> lower;
    for (const Option& o : best_of_each(options, bound_)) {
      const auto tried = std::find_if(trials_.all().begin(), trials_.all().end(),
                                      [&](const auto& t) { return t->row.id.name() == o.row.id.name(); });
      if (o.within || !(*tried)->look.within(bound_)) continue;
      const Trial& t = **tried;
      const auto knob = std::find_if(t.variant.entry->knobs.begin(), t.variant.entry->knobs.end(),
                                     [](const Knob& k) { return k.fine; });
      if (knob == t.variant.entry->knobs.end()) continue;
      const double share = 0.95 * bound_.value / o.row.timing.median_frame_ms();
      Variant v = t.variant;
      const int value = int(share * v.parameters.integer(knob->parameter));
      if (value < std::get<int>(knob->values.front())) continue;
      v.parameters.set(knob->parameter, value);
      if (const Trial* next = trials_.look(v, t.spheres)) lower.push_back(next);
    }
    for (Option& o : measured(lower)) options.push_back(std::move(o));
  }

  /// The best of the options that the search had found.
  std::optional<Option> searched(std::vector<Option> options, const std::vector<const Trial*>& found) const {
    std::erase_if(options, [&](const Option& o) {
      return std::none_of(found.begin(), found.end(),
                          [&](const Trial* t) { return t->row.id.name() == o.row.id.name(); });
    });
    options = best_of_each(std::move(options), bound_);
    return options.empty() ? std::nullopt : std::optional(options.front());
  }

  const ChooseSettings& settings_;
  const Bound bound_;
  const Registry& registry_;
  ResultsFolder& folder_;
  Progress& progress_;
  const double start_;
  double begin_ = 0.0;  ///< of the search, the truth being there
  Trials trials_;
  std::vector<Line> on_mesh_, on_spheres_;
  std::vector<std::string> left_out_;
  std::map<std::string, std::string> refusals_;  ///< by technique
};

}  // namespace

Answer choose(const ChooseSettings& settings, const Registry& registry, ResultsFolder& folder, Progress& progress) {
  return Chooser(settings, registry, folder, progress).run();
}

}  // namespace penumbra
