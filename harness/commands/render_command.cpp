// penumbra render: one image of one technique.

#include <CLI/CLI.hpp>
#include <chrono>

#include "harness/catalogue/catalogue.h"
#include "harness/commands/commands.h"
#include "harness/commands/frame_option.h"
#include "harness/commands/input_kind.h"
#include "harness/commands/save_image.h"
#include "harness/measure/black_truth.h"
#include "harness/measure/check.h"
#include "harness/measure/chosen_frame.h"
#include "harness/measure/progress.h"
#include "scenes/error.h"
#include "scenes/log.h"
#include "scenes/scene_file.h"
#include "techniques/registry.h"

namespace penumbra {
namespace {

struct RenderOptions {
  std::string scene, technique, backend, output;
  Parameters parameters;
  std::optional<int> spheres;
  std::optional<int> frame;  ///< absent: the one that `run` scores
};

void render(const RenderOptions& options) {
  const Registry registry = make_registry();
  expect_scene(options.scene, registry);
  const std::string backend =
      options.backend.empty() ? to_string(registry.usual_backends(options.technique).back()) : options.backend;
  const Entry& entry = registry.find(options.technique, backend);
  make_technique(entry, options.parameters);  // mistakes are told before the scene is loaded
  Progress progress;
  const Scene scene = load_scene(options.scene, {options.spheres, {}}, progress);
  if (const std::string why = reason_to_skip(entry, scene.light); !why.empty())
    throw Unsupported(fmt::format("{} {}: scene {}", entry.title(), why, scene.name));
  const auto technique = make_technique(entry, options.parameters, scene.light);
  progress.step("preparing " + entry.title());
  const auto start = std::chrono::steady_clock::now();
  technique->prepare(scene);
  Animation animation(scene);
  const int index = chosen_frame(animation, options.frame);
  const Frame frame = animation.frame(index);
  technique->update(frame);
  progress.step("shading with " + entry.title());
  const auto prepared = std::chrono::steady_clock::now();
  Image image{scene.receivers.width, scene.receivers.height, std::vector<vec3>(std::size_t(scene.receivers.size()))};
  technique->shade({image.pixels.data(), image.width, image.height});
  const auto shaded = std::chrono::steady_clock::now();
  progress.finish();
  save_image(options.output, image, frame);
  if (!light_arrives(frame.light, frame.receivers))
    warn("{}", black_note(scene.name, frame.light, frame.receivers, false));
  using ms = std::chrono::duration<double, std::milli>;
  const std::string which = frame_text(animation, index);
  fmt::print("{}: {}{}prepared in {:.1f} ms, shaded in {:.2f} ms (once, cold; `run` measures)\n", options.output, which,
             which.empty() ? "" : ", ", ms(prepared - start).count(), ms(shaded - prepared).count());
}

}  // namespace

void add_render(CLI::App& app, int&) {
  auto* command = app.add_subcommand("render", "Shade one scene with one technique");
  static RenderOptions options;
  static std::vector<std::string> parameters;
  command->add_option("scene", options.scene, "Shipped scene or path of a .toml file")->required();
  command->add_option("--technique", options.technique, "See: penumbra list")->required();
  command->add_option("--backend", options.backend, "scalar, simd or cuda; default: simd where the technique has it");
  command->add_option("-p", parameters, "Parameter, name=value");
  command->add_option("--spheres", options.spheres, "Fit so many in place of the scene's own")
      ->check(CLI::Range(1, 4096));
  add_frame_option(*command, options.frame);
  command->add_option("-o", options.output, "Image: .exr (linear) or .png (exposed)")->required();
  command->callback([] {
    options.parameters = parse_parameters(parameters);
    render(options);
  });
}

}  // namespace penumbra
