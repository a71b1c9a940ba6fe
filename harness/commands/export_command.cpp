// penumbra export: a scene in files, for someone else's renderer.
#include <fmt/format.h>

#include <CLI/CLI.hpp>

#include "harness/commands/commands.h"
#include "harness/commands/frame_option.h"
#include "harness/measure/chosen_frame.h"
#include "harness/measure/export_scene.h"
#include "scenes/scene_file.h"

namespace penumbra {
namespace {

struct ExportOptions {
  std::string scene, directory;
  std::optional<int> frame;  ///< absent: the one that `run` scores
};

void export_files(const ExportOptions& options) {
  const Scene scene = load_scene(options.scene);
  Animation animation(scene);
  const int index = chosen_frame(animation, options.frame);
  const Frame frame = animation.frame(index);
  export_scene(animation, frame, options.directory);
  const std::string which = frame_text(animation, index);
  fmt::print("{}: scene '{}'{}{}; scene.json says what the files hold\n", options.directory, scene.name,
             which.empty() ? "" : ", ", which);
  fmt::print("Make an image of {} x {} pixels from them, then: penumbra score {} IMAGE.exr{}\n", frame.receivers.width,
             frame.receivers.height, options.scene, options.frame ? fmt::format(" --frame {}", index) : "");
}

}  // namespace

void add_export(CLI::App& app, int&) {
  auto* command = app.add_subcommand("export", "Write a scene's mesh, light and receivers for another renderer");
  static ExportOptions options;
  command->add_option("scene", options.scene, "Shipped scene or path of a .toml file")->required();
  add_frame_option(*command, options.frame);
  command->add_option("-o", options.directory, "Folder to write to")->required();
  command->callback([] { export_files(options); });
}

}  // namespace penumbra
