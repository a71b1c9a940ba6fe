#include "harness/commands/dry_run.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <map>
#include <thread>

#include "harness/measure/check.h"
#include "harness/measure/chosen_frame.h"
#include "harness/measure/expected_time.h"
#include "harness/report/published.h"
#include "harness/report/published_times.h"
#include "harness/report/screen.h"
#include "harness/results/results_file.h"

namespace penumbra {
namespace {

constexpr int column = 16;

/// Of all scenes, in seconds and in rows.
struct Sum {
  double fits = 0.0, references = 0.0, rows = 0.0;
  std::size_t count = 0, measured = 0, skipped = 0, kept = 0;
};

/// "1 row", "2 rows".
std::string counted(std::size_t count, const std::string& what) {
  return fmt::format("{} {}{}", count, what, count == 1 ? "" : "s");
}

/// One scene of a plan, looked at but not run.
class DryScene {
 public:
  DryScene(const Plan& plan, const PlannedScene& planned, const std::vector<Row>& earlier, bool resume)
      : plan_(plan),
        planned_(planned),
        earlier_(earlier),
        resume_(resume),
        scene_(loaded(planned)),
        animation_(scene_) {}

  std::string describe(Sum& sum, std::string& labels_before, int width) {
    const SceneOutline& o = planned_.outline;
    const std::string spheres =
        o.spheres == 0 ? "no spheres" : counted(o.spheres, "sphere") + (o.fitted() ? " " + o.origin_of_spheres() : "");
    std::string text =
        wrapped(fmt::format("{}: {} receivers, {}", o.name, scene_.receivers.size(), spheres), width) + "\n";
    const auto line = [&](const char* label, const std::string& what) { text += labelled(label, what, column, width); };
    if (o.fitted()) line("fit", fit(sum));
    line("references", references(sum));
    const std::string labels = rows(sum);
    line("rows", labels == labels_before ? "the same" : labels);
    labels_before = labels;
    for (const auto& [reason, names] : skipped_) line("skipped", fmt::format("{}: {}", reason, fmt::join(names, ", ")));
    return text;
  }

 private:
  static Scene loaded(const PlannedScene& planned) {
    SphereChoice choice = planned.choice;
    choice.only_cached = true;
    return load_scene(planned.listed, choice);
  }

  std::string fit(Sum& sum) const {
    if (!scene_.spheres.empty()) return "in the cache";
    const double seconds = expected_fit(planned_.outline.spheres, planned_.outline.objective);
    sum.fits += seconds;
    return "to do, " + about(seconds);
  }

  std::string references(Sum& sum) {
    std::vector<std::string> there, missing;
    for (const Job& job : planned_.jobs) {
      if (job.kind == Job::Kind::sequence) {
        const int frames = animation_.frames(), cached = cached_truths();
        (cached == frames ? there : missing).push_back(fmt::format("truth of {} frames", frames));
        sum.references += (frames - cached) * seconds_for(Rung::truth);
      }
      if (job.kind != Job::Kind::reference) continue;
      const std::string name = to_string(job.rung) + (job.resolution ? fmt::format(" {}", job.resolution) : "");
      const bool cached = in_cache(job);
      (cached ? there : missing).push_back(name);
      if (!cached) sum.references += seconds_for(job.rung);
    }
    std::vector<std::string> parts;
    if (!there.empty()) parts.push_back(fmt::format("in the cache: {}", fmt::join(there, ", ")));
    if (!missing.empty()) parts.push_back(fmt::format("to compute: {}", fmt::join(missing, ", ")));
    return fmt::format("{}", fmt::join(parts, "; "));
  }

  /// Of the scored frame. A rung of spheres that are not fitted yet cannot be there.
  bool in_cache(const Job& job) {
    if (job.rung == Rung::spheres && scene_.spheres.empty()) return false;
    ReferenceSettings settings = settings_of();
    if (job.resolution) settings.resolution = job.resolution;
    return is_cached(animation_.frame(scored_frame(animation_)), job.rung, settings);
  }

  int cached_truths() {
    int count = 0;
    for (int f = 0; f < animation_.frames(); ++f)
      if (is_cached(animation_.frame(f), Rung::truth, settings_of())) ++count;
    return count;
  }

  ReferenceSettings settings_of() const {
    ReferenceSettings settings;
    settings.truth_noise = plan_.suite->truth_noise;
    return settings;
  }

  double seconds_for(Rung rung) const {
    return expected_reference(rung, !planned_.outline.lamps, scene_.receivers.size(), plan_.suite->truth_noise);
  }

  /// Labels of the rows that would be measured.
  std::string rows(Sum& sum) {
    std::vector<std::string> labels;
    for (const Job& job : planned_.jobs) {
      if (job.kind != Job::Kind::measurement) continue;
      const Variant& variant = plan_.suite->variants[job.variant];
      if (const std::string why = reason_to_skip(*variant.entry, scene_.light); !why.empty()) {
        skipped_[why].push_back(spaced(variant.label()));
        ++sum.skipped;
        continue;
      }
      labels.push_back(spaced(variant.label()));
      add_row(variant, sum);
    }
    return labels.empty() ? "none" : fmt::format("{}: {}", labels.size(), fmt::join(labels, ", "));
  }

  void add_row(const Variant& variant, Sum& sum) const {
    RowIdentity id = identity_of(planned_.outline, variant);
    id.receivers = std::size_t(scene_.receivers.size());
    if (!scene_.spheres.empty()) id.spheres = scene_.spheres.size();  // a fit may need fewer than were asked for
    const auto kept = [&](const Row& old) {
      return old.ok() && old.id.name() == id.name() && old.timing.frame_ms.size() >= std::size_t(plan_.repetitions);
    };
    ++sum.count;
    if (resume_ && std::any_of(earlier_.begin(), earlier_.end(), kept)) {
      ++sum.kept;
      return;
    }
    const int frames = plan_.suite->sequence ? animation_.frames() : 0;
    const ExpectedRow row = expected_row(id, plan_.repetitions, frames, earlier_);
    sum.rows += row.seconds;
    if (row.measured) ++sum.measured;
  }

  const Plan& plan_;
  const PlannedScene& planned_;
  const std::vector<Row>& earlier_;
  const bool resume_;
  const Scene scene_;
  Animation animation_;
  std::map<std::string, std::vector<std::string>> skipped_;  ///< by reason
};

/// About how long, and how that is known.
std::string expectation(const Sum& sum, const RunOptions& options) {
  std::string text = fmt::format(
      "{}: fits {:.0f} s, references {:.0f} s, rows {:.0f} s; {} of {} as measured in {}, all else by rough rates of "
      "{} "
      "cores.",
      about(sum.fits + sum.references + sum.rows), sum.fits, sum.references, sum.rows, sum.measured,
      counted(sum.count - sum.kept, "row"), options.directory, std::thread::hardware_concurrency());
  if (options.resume)
    text += fmt::format(" {} in {} already; --resume keeps what has today's inputs, program and machine.",
                        counted(sum.kept, "row"), options.directory);
  return text + " Nothing was measured or written.";
}

std::string headline(const Plan& plan, const Sum& sum) {
  return fmt::format("suite {}: {} on {}, {}{}", plan.suite->name, counted(sum.count, "row"),
                     counted(plan.scenes.size(), "scene"), counted(std::size_t(plan.repetitions), "repetition"),
                     sum.skipped ? fmt::format("; {} more skipped", sum.skipped) : "");
}

}  // namespace

void dry_run(const Suite& suite, const RunOptions& options) {
  if (!suite.published_times.empty()) check_published_times({suite.name, suite.published, suite.published_times});
  else if (!suite.published.empty()) PublishedTable::load(suite.published);
  const Plan plan = make_plan(suite, options.filter, options.repetitions);
  const std::vector<Row> earlier = read_results(options.directory).rows;
  const int width = screen_width();
  Sum sum;
  std::string text, labels;
  for (const PlannedScene& scene : plan.scenes)
    text += "\n" + DryScene(plan, scene, earlier, options.resume).describe(sum, labels, width);
  fmt::print("{}\n{}\n{}\n", wrapped(headline(plan, sum), width), text, wrapped(expectation(sum, options), width));
}

}  // namespace penumbra
