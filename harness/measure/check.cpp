#include "harness/measure/check.h"

#include <fmt/format.h>
#include <tbb/task_arena.h>

#include <cmath>

#include "harness/measure/parity.h"
#include "harness/results/statistics.h"
#include "scenes/unsupported.h"

namespace penumbra {
namespace {

/// Prepares, and shades the scored frame: the first time is cold, and counts only if it is long; then the median of
/// what takes 30 ms, five times at most.
void shade(const SceneContext& context, Checked& c) {
  const Receivers& r = context.scene().receivers;
  c.image = {r.width, r.height, std::vector<vec3>(std::size_t(r.size()), vec3(NAN))};
  SteadyClock clock;
  tbb::task_arena(c.row.id.threads).execute([&] {
    clock.start();
    c.technique->prepare(context.scene());
    c.row.timing.prepare_ms = clock.lap();
    c.technique->update(context.frame());
    c.update_ms = clock.lap();
    std::vector<double> warm;
    double sum = 0.0;
    do {
      clock.start();
      c.technique->shade({c.image.pixels.data(), r.width, r.height});
      const double ms = clock.lap();
      if (!warm.empty() || ms > 100.0 || sum > 0.0) warm.push_back(ms);
      sum += ms;
    } while (warm.size() < 5 && (warm.empty() || sum < 30.0));
    c.shade_ms = median(warm);
  });
}

void check_finite(const Image& image) {
  for (std::size_t i = 0; i < image.pixels.size(); ++i)
    for (int k = 0; k < 3; ++k)
      if (!std::isfinite(image.pixels[i][k]))
        throw std::runtime_error(fmt::format("receiver {} has the radiance {}", i, image.pixels[i][k]));
}

void collect_facts(const Technique& technique, Facts& facts) {
  facts.counters = technique.counters();
  facts.instruction_set = technique.instruction_set();
  const Footprint bytes = technique.footprint();
  facts.bytes = {bytes.tables, bytes.per_scene, bytes.per_frame};
}

void check_parity(const Registry& registry, const Variant& variant, const Scene& scene, Row& row) {
  const Entry& entry = *variant.entry;
  if (entry.backend == Backend::scalar) return;
  row.score.parity = parity_with_scalar(registry, entry, variant.parameters, scene);
  if (!(row.score.parity <= entry.parity))
    throw std::runtime_error(fmt::format("differs from its scalar twin by {:.3g} (relative RMSE); allowed is {:.3g}",
                                         row.score.parity, entry.parity));
}

void score(const SceneContext& context, const Variant& variant, bool attribution, const std::string& sheet_file,
           Checked& c) {
  const double parity = c.row.score.parity;
  c.row.score = context.score(c.image, variant.parameters);
  c.row.score.parity = parity;
  if (attribution) c.row.score.steps = context.attribute(*c.technique, c.image, variant.parameters);
  tbb::task_arena(variant.threads).execute([&] {
    c.row.score.sequence = context.score_sequence(*c.technique, sheet_file);
  });
}

}  // namespace

std::string reason_to_skip(const Entry& entry, const Light& light) {
  if (!entry.unavailable.empty()) return entry.unavailable;
  for (const Light& one : each_of(light))
    if (!entry.lights.accepts(one))
      return environment_of(one) ? "cannot shade an environment" : "cannot shade an area light";
  return "";
}

Row empty_row(const Variant& variant, const SceneContext& context, const Suite& suite) {
  const Scene& scene = context.scene();
  SceneOutline as_loaded;  // a fit may need fewer spheres than were asked for
  as_loaded.name = scene.name, as_loaded.spheres = scene.spheres.size(), as_loaded.objective = scene.objective;
  Row row;
  row.id = identity_of(as_loaded, variant);
  row.id.receivers = std::size_t(scene.receivers.size());
  row.facts.scene_key = context.key();
  row.facts.key = measurement_key(context.key(), scene, row.id, suite);
  if (variant.external) row.facts.key = external_key(*variant.external, row.facts.key);
  if (const std::string why = reason_to_skip(*variant.entry, scene.light); !why.empty()) row.status = "skipped: " + why;
  return row;
}

namespace {

/// `registry`: where the scalar twin is; absent: parity is not asked for.
Checked checked(const Variant& variant, const SceneContext& context, const Suite& suite, const Registry* registry,
                const std::string& sheet_file) {
  Checked c;
  c.row = empty_row(variant, context, suite);
  if (!c.row.ok()) return c;
  try {
    c.technique = make_technique(*variant.entry, variant.parameters, context.scene().light);
    shade(context, c);
    check_finite(c.image);
    collect_facts(*c.technique, c.row.facts);
    c.row.timing.view_ms = context.view_ms(variant.threads);
    if (registry) check_parity(*registry, variant, context.scene(), c.row);
    score(context, variant, suite.attribution, sheet_file, c);
    return c;
  } catch (const Unsupported& e) {
    c.row.status = std::string("skipped: ") + e.what();
  } catch (const std::exception& e) {
    c.row.status = std::string("failed: ") + e.what();
  }
  c.technique.reset();
  c.row.score.errors.clear();
  return c;
}

}  // namespace

Checked look_at(const Variant& variant, const SceneContext& context, const Suite& suite) {
  return checked(variant, context, suite, nullptr, "");
}

Checked check(const Variant& variant, const SceneContext& context, const Suite& suite, const Registry& registry,
              const std::string& sheet_file) {
  return checked(variant, context, suite, &registry, sheet_file);
}

}  // namespace penumbra
