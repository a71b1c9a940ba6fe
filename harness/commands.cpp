#include "harness/commands.h"

#include <fmt/ranges.h>

#include <chrono>
#include <nlohmann/json.hpp>

#include "cuda/register_cuda.h"
#include "harness/metrics.h"
#include "harness/reference.h"
#include "scenes/assets.h"
#include "scenes/error.h"
#include "scenes/scene_file.h"
#include "techniques/registry.h"

namespace penumbra {
namespace {

/// .exr as it is, everything else exposed for a display.
void save(const std::string& path, Image image, const std::vector<bool>& valid) {
  if (path.ends_with(".exr")) return save_exr(path, image);
  if (!path.ends_with(".png")) throw Error("-o {}: the name must end in .exr or .png", path);
  const double exposure = exposure_for(image, valid);
  for (vec3& p : image.pixels) p *= float(exposure);
  save_png(path, image);
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
  if (!entry.unavailable.empty()) throw Unsupported(entry.title() + " cannot run: " + entry.unavailable);
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
  save(options.output, image, valid_receivers(frame.receivers));
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
  const double scale = rms(r.mean, valid);
  fmt::print("{} {}: {} receivers, {} rays each, {:.2f} s{}, RMS {:.5g} W m^-2 sr^-1, standard error {:.3g} % of it\n",
             scene.name, to_string(rung), valid.size(), r.rays_per_receiver, r.seconds,
             r.from_cache ? " (from the cache)" : "", scale, scale > 0 ? 100.0 * r.noise(valid) / scale : 0.0);
  if (!options.output.empty()) save(options.output, r.mean, valid);
}

}  // namespace penumbra
