#include "harness/measure/reference.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>

#include "harness/measure/interrupt.h"
#include "harness/measure/truth_rounds.h"
#include "harness/results/metrics.h"
#include "scenes/error.h"
#include "scenes/log.h"
#include "techniques/bases/light_sampling.h"
#include "techniques/bases/pixel_sum.h"
#include "techniques/bases/sphere_table.h"

namespace penumbra {

std::string to_string(Rung rung) {
  switch (rung) {
    case Rung::truth:
      return "truth";
    case Rung::r13x13:
      return "13x13";
    case Rung::cube:
      return "cube";
    default:
      return "spheres";
  }
}

Rung parse_rung(const std::string& name) {
  for (const Rung rung : {Rung::truth, Rung::r13x13, Rung::cube, Rung::spheres})
    if (to_string(rung) == name) return rung;
  throw Error("unknown rung '{}'; allowed are truth, 13x13, cube, spheres", name);
}

std::vector<bool> valid_receivers(const Receivers& receivers) {
  std::vector<bool> valid(receivers.normal.size());
  for (int i = 0; i < receivers.size(); ++i) valid[i] = receivers.valid(i);
  return valid;
}

double Reference::noise(const std::vector<bool>& valid) const {
  double sum = 0.0;
  std::size_t count = 0;
  for (std::size_t i = 0; i < valid.size(); ++i)
    if (valid[i]) sum += double(variance.pixels[i].x + variance.pixels[i].y + variance.pixels[i].z), ++count;
  return count ? std::sqrt(sum / (3.0 * double(count))) : 0.0;
}

namespace {

bool reaches_noise(const Reference& truth, const Receivers& receivers, const ReferenceSettings& settings) {
  const std::vector<bool> valid = valid_receivers(receivers);
  return truth.noise(valid) <= settings.truth_noise * rms(truth.mean, valid);
}

}  // namespace

void warn_of_noise(const Reference& reference, const Receivers& receivers, const ReferenceSettings& settings) {
  if (reference.rung != Rung::truth || reaches_noise(reference, receivers, settings)) return;
  const std::vector<bool> valid = valid_receivers(receivers);
  warn(
      "the truth's standard error is {:.2g} % of its RMS after {} rays a receiver, {:.2g} % was asked for: errors "
      "below "
      "it are ties; ask for no less than it (--noise, truth_noise), or look at receivers that more light reaches",
      100.0 * reference.noise(valid) / rms(reference.mean, valid), reference.rays_per_receiver,
      100.0 * settings.truth_noise);
}

std::string inapplicable(const Frame& frame, Rung rung) {
  for (const Light& light : each_of(frame.light)) {
    const bool environment = environment_of(light) != nullptr;
    if (rung == Rung::r13x13 && environment) return "the rung 13x13 is for area lights";
    if ((rung == Rung::cube || rung == Rung::spheres) && !environment)
      return "the rung " + to_string(rung) + " is for environments";
  }
  if (rung == Rung::spheres && frame.spheres.empty()) return "the scene has no spheres";
  return "";
}

namespace {

Image blank(const Receivers& r) {
  return {r.width, r.height, std::vector<vec3>(std::size_t(r.size()), vec3(0.0f))};
}

/// How many rounds the truth will take: its noise falls with the root of their number.
double predicted_rounds(const Reference& so_far, int rounds, const Receivers& receivers,
                        const ReferenceSettings& settings) {
  const std::vector<bool> valid = valid_receivers(receivers);
  const double noise = so_far.noise(valid), wanted = settings.truth_noise * rms(so_far.mean, valid);
  return noise > wanted && wanted > 0.0 ? double(rounds) * (noise / wanted) * (noise / wanted) : double(rounds);
}

void compute_truth(const Frame& frame, const ReferenceSettings& settings, std::size_t light, Reference& out,
                   const ReferenceProgress& progress) {
  constexpr int first_look = 2, fewest = TruthRounds::fewest;
  TruthRounds sampler(frame, settings, light, out);
  const int most = sampler.most_rounds();
  double predicted = most;
  const auto look = [&](int rounds) {
    sampler.finish();
    predicted = std::clamp(predicted_rounds(out, rounds, frame.receivers, settings), double(fewest), double(most));
  };
  int rounds = 0;
  for (int next = fewest; rounds < most; next = std::min(most, rounds + sampler.rounds_to_next_look())) {
    while (rounds < next) {
      sampler.round(rounds++);
      if (progress && rounds == first_look) look(rounds);
      if (progress) progress(std::min(1.0, double(rounds) / predicted));
    }
    look(rounds);
    if (reaches_noise(out, frame.receivers, settings)) return;
  }
}

/// Counts what is done, from any thread, and tells a hundred times in all how far the whole is.
class Tally {
 public:
  Tally(int whole, const ReferenceProgress& progress)
      : whole_(whole), step_(std::max(1, whole / 100)), progress_(progress) {}
  void one_more() {
    const int done = ++done_;
    if (progress_ && done % step_ == 0) progress_(double(done) / double(whole_));
  }

 private:
  const int whole_, step_;
  const ReferenceProgress& progress_;
  std::atomic<int> done_ = 0;
};

constexpr int cells = 13;

LightSample cell_sample(const AreaLight& light, const Receivers& r, int i, int cell) {
  const int column = cell % cells, row = cell / cells;
  return sample_area(light, r.position[i], r.normal[i], (float(column) + 0.5f) / cells, (float(row) + 0.5f) / cells);
}

void compute_13x13(const Frame& frame, Reference& out, const ReferenceProgress& progress) {
  const AreaLight& light = *area_light_of(frame.light);
  const RayScene rays(frame.mesh);
  const Receivers& r = frame.receivers;
  out.rays_per_receiver = cells * cells;
  Tally tally(r.size(), progress);
  tbb::parallel_for(0, r.size(), [&](int i) {
    tally.one_more();
    if (!r.valid(i) || interrupted()) return;
    std::vector<LightSample> samples;
    dvec3 open(0.0);
    for (int cell = 0; cell < cells * cells; ++cell) {
      samples.push_back(cell_sample(light, r, i, cell));
      open += dvec3(samples.back().weight);
    }
    out.mean.pixels[i] = r.albedo[i] * estimate_radiance(rays, r.ray_origin(i), samples);
    out.unshadowed.pixels[i] = r.albedo[i] * vec3(open / double(cells * cells));
  });
}

void compute_texels(const Frame& frame, Rung rung, int n, Reference& out, const ReferenceProgress& progress) {
  const CubeLight light(*environment_of(frame.light), n);
  const RayScene rays(rung == Rung::cube ? frame.mesh : Mesh{});
  const Receivers& r = frame.receivers;
  out.rays_per_receiver = rung == Rung::cube ? 6 * n * n : 0;
  Tally tally(r.size(), progress);
  tbb::parallel_for(0, r.size(), [&](int i) {
    tally.one_more();
    if (!r.valid(i) || interrupted()) return;
    BitCube blocked(n);
    out.unshadowed.pixels[i] = pixel_sum(light, blocked, r.normal[i], r.albedo[i]);
    if (rung == Rung::cube) trace_texels(rays, r.ray_origin(i), r.normal[i], light.directions, true, blocked);
    else if (!r.on_occluder[i]) rasterise_spheres(frame.spheres, r.position[i], light.directions, blocked);
    out.mean.pixels[i] = pixel_sum(light, blocked, r.normal[i], r.albedo[i]);
  });
}

}  // namespace

void check_finite(const Reference& reference, const Receivers& receivers) {
  const std::pair<const char*, const Image*> images[] = {
      {"radiance", &reference.mean}, {"variance", &reference.variance}, {"unshadowed radiance", &reference.unshadowed}};
  for (const auto& [what, image] : images)
    for (std::size_t i = 0; i < image->pixels.size(); ++i)
      for (int c = 0; c < 3; ++c)
        if (const float value = image->pixels[i][c]; !std::isfinite(value)) {
          const vec3 p = receivers.position[i];
          throw Error(
              "{}: receiver {} at ({:.4g}, {:.4g}, {:.4g}) has the {} {}: a number of the scene is not finite or too "
              "large "
              "for float; look at its light, or give the light in a larger unit",
              to_string(reference.rung), i, p.x, p.y, p.z, what, value);
        }
}

namespace {

Reference of_one_light(const Frame& frame, std::size_t light, Rung rung, const ReferenceSettings& settings,
                       const ReferenceProgress& progress) {
  Reference out;
  out.rung = rung;
  out.mean = out.variance = out.unshadowed = blank(frame.receivers);
  if (rung == Rung::truth) compute_truth(frame, settings, light, out, progress);
  else if (rung == Rung::r13x13) compute_13x13(frame, out, progress);
  else compute_texels(frame, rung, settings.resolution, out, progress);
  return out;
}

/// Light adds up, and so do variances of independent samples.
void add(Reference& sum, const Reference& one) {
  for (const auto image : {&Reference::mean, &Reference::variance, &Reference::unshadowed})
    for (std::size_t i = 0; i < (sum.*image).pixels.size(); ++i) (sum.*image).pixels[i] += (one.*image).pixels[i];
  sum.rays_per_receiver += one.rays_per_receiver;
}

}  // namespace

Reference compute_reference(const Frame& frame, Rung rung, const ReferenceSettings& settings,
                            const ReferenceProgress& progress) {
  if (const std::string why = inapplicable(frame, rung); !why.empty()) throw Unsupported(why);
  const auto start = std::chrono::steady_clock::now();
  const std::span<const Light> lights = each_of(frame.light);
  Reference out;
  for (std::size_t k = 0; k < lights.size(); ++k) {
    const Frame lit{frame.time, frame.mesh, frame.spheres, lights[k], frame.receivers, frame.changed};
    const ReferenceProgress part = [&](double share) { progress((double(k) + share) / double(lights.size())); };
    Reference one = of_one_light(lit, k, rung, settings, progress ? part : progress);
    stop_if_interrupted();
    if (k == 0) out = std::move(one);
    else add(out, one);
  }
  check_finite(out, frame.receivers);
  warn_of_noise(out, frame.receivers, settings);
  out.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return out;
}

float visibility_13x13(const Frame& frame, int receiver) {
  const RayScene rays(frame.mesh);
  const Receivers& r = frame.receivers;
  const vec3 origin = r.ray_origin(receiver);
  int open = 0;
  for (int cell = 0; cell < cells * cells; ++cell) {
    const LightSample s = cell_sample(*area_light_of(frame.light), r, receiver, cell);
    open += !rays.occluded(origin, s.direction, s.reach());
  }
  return float(open) / float(cells * cells);
}

}  // namespace penumbra
