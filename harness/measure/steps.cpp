#include "harness/measure/steps.h"

#include <fmt/format.h>

#include <algorithm>

namespace penumbra {
namespace {

/// Sum over valid receivers and channels of a * b.
double dot(const Image& a, const Image& b, const std::vector<bool>& valid) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.pixels.size(); ++i)
    if (valid[i]) sum += glm::dot(dvec3(a.pixels[i]), dvec3(b.pixels[i]));
  return sum;
}

}  // namespace

std::vector<StepError> attribute_error(const std::vector<Approximation>& approximations, const Image& rung,
                                       const Image& own, const std::vector<bool>& valid) {
  const double scale = rms(rung, valid);
  if (!(scale > 0.0)) return {};
  const Image whole = difference(own, rung);
  const double squared = dot(whole, whole, valid);
  std::vector<StepError> steps;
  Image before = rung;
  for (const Approximation& at : approximations) {
    const Image after = at.radiance.empty() ? own : Image{rung.width, rung.height, at.radiance};
    const Image step = difference(after, before);
    steps.push_back({at.name, rms(step, valid) / scale, squared > 0.0 ? dot(step, whole, valid) / squared : 0.0});
    before = after;
  }
  return steps;
}

std::string make_steps_table(const std::vector<Row>& rows) {
  std::string text;
  for (const Row& row : rows) {
    if (!row.ok() || row.steps.empty()) continue;
    if (text.empty())
      text =
          "\n## What each approximation adds\n\nFrom rung `spheres` to the technique's image, one approximation after "
          "the other: relative RMSE of the step in percent, and in brackets its share of the whole error (shares add "
          "up "
          "to 100; a negative one makes up for others). `geometry`: from rung cube to rung spheres.\n\n"
          "| scene | variant | spheres | geometry % | steps | all of them % | truth % "
          "|\n|---|---|---|---|---|---|---|\n";
    std::string steps;
    for (const StepError& step : row.steps)
      steps += fmt::format("{}{} {:.3g} ({:.0f})", steps.empty() ? "" : ", ", step.name, 100.0 * step.rel_rmse,
                           100.0 * step.share);
    text += fmt::format("| {} | {} | {} {} | {} | {} | {} | {} |\n", row.scene, row.variant(), row.spheres,
                        row.objective, geometry_text(row), steps, rung_text(row, "spheres"), rung_text(row, "truth"));
  }
  return text;
}

std::string make_counters_table(const std::vector<Row>& rows) {
  std::string text;
  for (const Row& row : rows) {
    std::string counts;
    for (const auto& [name, count] : row.counters)
      if (count > 0) counts += fmt::format("{}{} {}", counts.empty() ? "" : ", ", count, name);
    if (row.ok() && !counts.empty()) text += fmt::format("- {}: {}\n", row.name(), counts);
  }
  return text.empty() ? "" : "\n## Counted while shading\n\n" + text;
}

}  // namespace penumbra
