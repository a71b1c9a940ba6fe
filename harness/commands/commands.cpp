#include "harness/commands/commands.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <chrono>
#include <nlohmann/json.hpp>

#include "cuda/register_cuda.h"
#include "harness/measure/black_truth.h"
#include "harness/measure/reference.h"
#include "harness/results/metrics.h"
#include "harness/results/pictures.h"
#include "scenes/assets.h"
#include "scenes/error.h"
#include "scenes/log.h"
#include "scenes/scene_file.h"
#include "techniques/registry.h"

namespace penumbra {
namespace {

/// .exr as it is, everything else exposed for a display.
void save(const std::string& path, const Image& image, const Frame& frame) {
  if (path.ends_with(".exr")) return save_exr(path, image);
  if (!path.ends_with(".png")) throw Error("-o {}: the name must end in .exr or .png", path);
  const double light = light_scale(frame.light, frame.receivers);
  save_png(path, exposed(image, exposure_for(image, valid_receivers(frame.receivers), light)));
}

void list_as_json(const Registry& registry) {
  nlohmann::json out = {{"techniques", nlohmann::json::array()},
                        {"cuda", cuda_status()},
                        {"scenes", shipped_names("library")},
                        {"suites", shipped_names("suites")}};
  for (const Entry& e : registry.entries()) {
    nlohmann::json entry = {{"name", e.name},
                            {"backend", e.backend},
                            {"summary", e.summary},
                            {"citation", e.citation},
                            {"available", e.unavailable.empty()},
                            {"reason", e.unavailable},
                            {"lights", {{"environment", e.lights.environment}, {"area", e.lights.area}}}};
    for (const Parameter& p : e.parameters)
      entry["parameters"].push_back({{"name", p.name},
                                     {"unit", p.unit},
                                     {"default", to_string(p.fallback)},
                                     {"allowed", p.range()},
                                     {"meaning", p.meaning}});
    out["techniques"].push_back(entry);
  }
  fmt::print("{}\n", out.dump(1));
}

std::string reference_line(const std::string& scene, const Reference& r, const std::vector<bool>& valid, double black) {
  const double scale = rms(r.mean, valid);
  const auto error = relative(r.noise(valid), scale, black);
  const auto average = mean(r.mean, valid);
  return fmt::format(
      "{} {}: {} receivers, {} rays each, {:.2f} s{}, RMS {:.5g} W m^-2 sr^-1, standard error {}, mean {}", scene,
      to_string(r.rung), valid.size(), r.rays_per_receiver, r.seconds, r.from_cache ? " (from the cache)" : "", scale,
      error ? fmt::format("{:.3g} % of it", 100.0 * *error) : "undefined (of a black image)",
      average ? fmt::format("({:.5g}, {:.5g}, {:.5g})", average->x, average->y, average->z) : "undefined");
}

/// The same figures, and null where they are undefined.
nlohmann::json reference_json(const std::string& scene, const Reference& r, const std::vector<bool>& valid,
                              double black) {
  const double scale = rms(r.mean, valid);
  const auto error = relative(r.noise(valid), scale, black);
  const auto average = mean(r.mean, valid);
  return {{"scene", scene},
          {"rung", to_string(r.rung)},
          {"receivers", valid.size()},
          {"valid_receivers", std::count(valid.begin(), valid.end(), true)},
          {"rays_per_receiver", r.rays_per_receiver},
          {"seconds", r.seconds},
          {"from_cache", r.from_cache},
          {"rms", scale},
          {"mean", average ? nlohmann::json{average->x, average->y, average->z} : nlohmann::json(nullptr)},
          {"noise", r.noise(valid)},
          {"rel_noise", error ? nlohmann::json(*error) : nlohmann::json(nullptr)},
          {"black", !(scale > black)}};
}

}  // namespace

void list(bool json) {
  const Registry registry = make_registry();
  if (json) return list_as_json(registry);
  fmt::print("techniques\n");
  for (const Entry& e : registry.entries()) {
    fmt::print("  {:32} {}{}\n", e.title(), e.summary, e.unavailable.empty() ? "" : " [" + e.unavailable + "]");
    for (const Parameter& p : e.parameters)
      fmt::print("      {} = {}  ({}) {}{}\n", p.name, to_string(p.fallback), p.range(), p.meaning,
                 p.unit.empty() ? "" : " [" + p.unit + "]");
  }
  fmt::print("cuda: {}\nscenes: {}\nsuites: {}\n", cuda_status(), fmt::join(shipped_names("library"), ", "),
             fmt::join(shipped_names("suites"), ", "));
}

void render(const RenderOptions& options) {
  const Registry registry = make_registry();
  const Entry& entry = registry.find(options.technique, options.backend);
  const auto technique = make_technique(entry, options.parameters);
  const Scene scene = load_scene(options.scene);
  if (!entry.lights.accepts(scene.light))
    throw Unsupported(entry.title() + " cannot shade the light of scene " + scene.name);
  const auto start = std::chrono::steady_clock::now();
  technique->prepare(scene);
  Animation animation(scene);
  const Frame frame = animation.frame(0);
  technique->update(frame);
  const auto prepared = std::chrono::steady_clock::now();
  Image image{scene.receivers.width, scene.receivers.height, std::vector<vec3>(std::size_t(scene.receivers.size()))};
  technique->shade({image.pixels.data(), image.width, image.height});
  const auto shaded = std::chrono::steady_clock::now();
  save(options.output, image, frame);
  if (!light_arrives(frame.light, frame.receivers))
    warn("{}", black_note(scene.name, frame.light, frame.receivers, false));
  using ms = std::chrono::duration<double, std::milli>;
  fmt::print("{}: prepared in {:.1f} ms, shaded in {:.2f} ms (once, cold; `run` measures)\n", options.output,
             ms(prepared - start).count(), ms(shaded - prepared).count());
}

void reference(const ReferenceOptions& options) {
  const Scene scene = load_scene(options.scene);
  const Rung rung = parse_rung(options.rung);
  ReferenceSettings settings;
  settings.truth_noise = options.noise;
  settings.resolution = options.resolution;
  Animation animation(scene);
  const Frame frame = animation.frame(0);
  if (const std::string why = inapplicable(frame, rung); !why.empty()) throw Unsupported(why);
  const Reference r =
      options.fresh ? compute_reference(frame, rung, settings) : cached_reference(frame, rung, settings);
  const auto valid = valid_receivers(frame.receivers);
  const double black = black_level(frame.light, frame.receivers);
  fmt::print("{}\n", options.json ? reference_json(scene.name, r, valid, black).dump(1)
                                  : reference_line(scene.name, r, valid, black));
  if (!(rms(r.mean, valid) > black))
    warn("{}", black_note(scene.name, frame.light, frame.receivers, rms(r.unshadowed, valid) > black));
  if (!options.output.empty()) save(options.output, r.mean, frame);
}

}  // namespace penumbra
