// Runs every kernel once between marks for callgrind, which counts its instructions and cache lines. The program of
// scripts/instruction_counts.py, which also reads callgrind's files; docs/kernel-counts.md says what is counted.
//
//   valgrind --tool=callgrind --instr-atstart=no ... instruction_counts [--jobs N] [--only TEXT]... SCENE...
//
// Every variant has a process of its own, split off when the scenes are loaded: what a variant allocates depends on no
// other one. Prints JSON: what the counts depend on, and the variants. Callgrind's dumps are called "<variant>
// <stage>". Exit code 1: a variant failed, 2: wrong arguments or scenes, 3: this processor lacks the instruction set.
#include <fmt/format.h>
#include <gnu/libc-version.h>
#include <hwy/highway.h>
#include <hwy/targets.h>
#include <sys/wait.h>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>
#include <tbb/version.h>
#include <unistd.h>
#include <valgrind/callgrind.h>

#include <algorithm>
#include <charconv>
#include <deque>
#include <map>
#include <nlohmann/json.hpp>

#include "scenes/error.h"
#include "scenes/scene_file.h"
#include "techniques/all.h"
#include "techniques/registry.h"

namespace penumbra {
namespace {

/// The same on every processor: callgrind knows nothing newer.
constexpr auto instruction_set = HWY_AVX2;

struct Options {
  int jobs = 1;
  std::vector<std::string> only = {};  ///< variants that have one of these in their text; none: all
  std::vector<std::string> scenes;
};

Options parse(const std::vector<std::string>& arguments) {
  Options options;
  for (std::size_t i = 0; i < arguments.size(); ++i) {
    const bool named = arguments[i] == "--jobs" || arguments[i] == "--only";
    if (named && i + 1 == arguments.size()) throw Error("{} needs a value", arguments[i]);
    if (arguments[i] == "--only") options.only.push_back(arguments[++i]);
    else if (!named) options.scenes.push_back(arguments[i]);
    else {
      const std::string& text = arguments[++i];
      const auto parsed = std::from_chars(text.data(), text.data() + text.size(), options.jobs);
      if (parsed.ptr != text.data() + text.size() || options.jobs < 1) throw Error("--jobs {}: give 1 or more", text);
    }
  }
  if (options.scenes.empty()) throw Error("usage: instruction_counts [--jobs N] [--only TEXT]... SCENE...");
  return options;
}

/// In place of an environment a small one: a dim sky with lamps. Its texels fall exactly on those of the techniques'
/// cubes and are projected in no time; to project one as large as measured ones are would be nearly all that counts.
Scene with_small_light(Scene scene) {
  auto* environment = std::get_if<Environment>(&scene.light);
  if (!environment) return scene;
  *environment = {Mapping::cube, 8, 48, {}, 0.0};
  for (int i = 0; i < 6 * 8 * 8; ++i)
    environment->radiance.push_back(i % 37 == 5 ? vec3(20.0f, 15.0f, 10.0f) : vec3(0.05f) + 0.001f * float(i % 11));
  return scene;
}

Scene twisting(Scene scene) {
  scene.motion = {Motion::Kind::twist, 0.5f, 16.0f, 16};
  return scene;
}

Light changed(Light light) {
  if (auto* environment = std::get_if<Environment>(&light)) std::ranges::reverse(environment->radiance);
  if (auto* area = std::get_if<AreaLight>(&light)) area->centre += 0.125f * area->edge_u;
  return light;
}

/// A scene, and frames in each of which its shape, or its light, differs from the frame before.
struct Moments {
  explicit Moments(Scene at_rest) : scene(twisting(std::move(at_rest))), light(changed(scene.light)) {}
  Moments(const Moments&) = delete;
  Moments& operator=(const Moments&) = delete;

  Scene scene;
  Light light;
  Animation first{scene}, second{scene};
  Frame shape[2] = {first.frame(1), second.frame(2)};
  Frame new_shape[2] = {shape[0], with(shape[1], light, shape[1].changed)};
  Frame new_light[2] = {with(shape[0], light, {.light = true}), with(shape[1], scene.light, {.light = true})};

 private:
  static Frame with(const Frame& frame, const Light& light, Changes changed) {
    return {frame.time, frame.mesh, frame.spheres, light, frame.receivers, changed};
  }
};

struct Variant {
  const Entry& entry;
  const Moments& moments;
  Parameters parameters;
  std::string way;  ///< what differs from the small parameters: "visibility=raster" or nothing
  std::string text() const {
    return fmt::format("{} {} {} {}", entry.name, to_string(entry.backend), moments.scene.name, way);
  }
};

/// What may have a kernel of its own: the words that a parameter may be, and numbers where there are few. What the
/// small parameters set is how much is done, not how.
std::vector<ParameterValue> ways(const Entry& entry, const Parameter& p) {
  if (entry.small.all().contains(p.name)) return {};
  if (!p.allowed.empty()) return p.allowed;
  std::vector<ParameterValue> values;
  if (std::holds_alternative<int>(p.fallback) && p.high - p.low < 5.0)
    for (int value = int(p.low); value <= int(p.high); ++value) values.emplace_back(value);
  return values;
}

/// Every technique on the processor: its small parameters, and each other way of one parameter. The oracle of a
/// vectorised twin is slow by intent, and counted once.
std::vector<Variant> all_variants(const Registry& registry, const std::deque<Moments>& scenes,
                                  const std::vector<std::string>& only) {
  std::vector<Variant> variants;
  const auto add = [&](Variant variant) {
    const std::string text = variant.text();
    const auto named = [&](const std::string& part) { return text.find(part) != std::string::npos; };
    if (only.empty() || std::ranges::any_of(only, named)) variants.push_back(std::move(variant));
  };
  for (const Entry& entry : registry.entries())
    for (const Moments& moments : scenes) {
      if (entry.backend != Backend::scalar && entry.backend != Backend::simd) continue;
      if (!entry.lights.accepts(moments.scene.light)) continue;
      add({entry, moments, entry.small, ""});
      if (entry.backend == Backend::scalar && registry.twin(entry, Backend::simd)) continue;
      for (const Parameter& p : entry.parameters)
        for (const ParameterValue& value : ways(entry, p)) {
          if (value == p.fallback) continue;
          Parameters parameters = entry.small;
          parameters.set(p.name, value);
          add({entry, moments, std::move(parameters), p.name + "=" + to_string(value)});
        }
    }
  return variants;
}

enum Outcome { counted = 0, failed = 1, left_out = 4 };

Outcome count(const Variant& variant, std::size_t number) {
  const Moments& moments = variant.moments;
  const auto technique = make_technique(variant.entry, variant.parameters);
  technique->prepare(moments.scene);
  const Receivers& receivers = moments.scene.receivers;
  std::vector<vec3> image(std::size_t(receivers.size()));
  const View<vec3> view{image.data(), receivers.width, receivers.height};
  // Counts what `work` does, from empty caches: to start clears them, but not what was counted before.
  const auto stage = [&](const char* name, const auto& work) {
    const std::string label = fmt::format("{} {}", number, name);
    CALLGRIND_START_INSTRUMENTATION;
    CALLGRIND_ZERO_STATS;
    work();
    CALLGRIND_DUMP_STATS_AT(label.c_str());
    CALLGRIND_STOP_INSTRUMENTATION;
  };

  technique->update(moments.new_shape[0]);  // what is done once only: dispatch to an instruction set, tables
  technique->shade(view);
  technique->update(moments.new_light[0]);
  stage("new shape", [&] { technique->update(moments.new_shape[1]); });
  stage("shade", [&] { technique->shade(view); });
  stage("new light", [&] { technique->update(moments.new_light[1]); });
  return counted;
}

/// Of the process that was split off for it.
Outcome outcome(const Variant& variant, std::size_t number) {
  try {
    return tbb::task_arena(1).execute([&] { return count(variant, number); });
  } catch (const Unsupported&) {
    return left_out;
  } catch (const Error&) {  // a parameter that excludes another
    return left_out;
  } catch (const std::exception& e) {
    fmt::print(stderr, "instruction_counts: {}: {}\n", variant.text(), e.what());
    return failed;
  }
}

/// The exit status of every variant's process.
std::vector<int> count_all(const std::vector<Variant>& variants, int jobs) {
  std::vector<int> statuses(variants.size(), -1);
  std::map<pid_t, std::size_t> running;
  const auto wait_for_one = [&] {
    int status = 0;
    const pid_t ended = wait(&status);
    statuses.at(running.at(ended)) = WIFEXITED(status) ? WEXITSTATUS(status) : failed;
    running.erase(ended);
  };
  for (std::size_t i = 0; i < variants.size(); ++i) {
    if (running.size() == std::size_t(jobs)) wait_for_one();
    const pid_t child = fork();
    if (child < 0) throw Error("no process for {}", variants[i].text());
    if (child == 0) _exit(outcome(variants[i], i));
    running.emplace(child, i);
  }
  while (!running.empty()) wait_for_one();
  return statuses;
}

nlohmann::json context() {
  return {{"compiler", PENUMBRA_COMPILER},
          {"flags", PENUMBRA_FLAGS},
          {"instruction set", hwy::TargetName(instruction_set)},
          {"libraries", fmt::format("{}, TBB {}.{}, glibc {}", PENUMBRA_LIBRARIES, TBB_VERSION_MAJOR, TBB_VERSION_MINOR,
                                    gnu_get_libc_version())}};
}

int run(const Options& options) {
  const tbb::global_control one_thread(tbb::global_control::max_allowed_parallelism, 1);
  if (!(hwy::SupportedTargets() & instruction_set)) {
    fmt::print(stderr, "instruction_counts: this processor lacks {}\n", hwy::TargetName(instruction_set));
    return 3;
  }
  hwy::SetSupportedTargetsForTest(instruction_set);
  hwy::GetChosenTarget().Update(hwy::SupportedTargets());
  std::deque<Moments> scenes;
  for (const std::string& scene : options.scenes) scenes.emplace_back(with_small_light(load_scene(scene)));
  Registry registry;
  register_techniques(registry);
  const std::vector<Variant> variants = all_variants(registry, scenes, options.only);
  const std::vector<int> statuses = count_all(variants, options.jobs);

  nlohmann::json out = {{"context", context()}, {"variants", nlohmann::json::object()}};
  int failures = 0;
  for (std::size_t i = 0; i < variants.size(); ++i) {
    const Variant& v = variants[i];
    if (statuses[i] == counted)
      out["variants"][std::to_string(i)] = {{"technique", v.entry.name},
                                            {"backend", to_string(v.entry.backend)},
                                            {"light", v.moments.scene.name},
                                            {"way", v.way}};
    else if (statuses[i] != left_out) {
      fmt::print(stderr, "instruction_counts: {} failed with exit code {}\n", v.text(), statuses[i]);
      ++failures;
    }
  }
  fmt::print("{}\n", out.dump());
  return failures > 0 ? 1 : 0;
}

}  // namespace
}  // namespace penumbra

int main(int argc, char** argv) {
  try {
    return penumbra::run(penumbra::parse({argv + 1, argv + argc}));
  } catch (const std::exception& e) {
    fmt::print(stderr, "instruction_counts: {}\n", e.what());
    return 2;
  }
}
