#include "harness/measure/run_external.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <stdexcept>

#include "harness/measure/child_process.h"
#include "harness/measure/export_scene.h"
#include "harness/measure/foreign_image.h"

namespace penumbra {
namespace {

std::string new_folder() {
  std::string pattern = (std::filesystem::temp_directory_path() / "penumbra-scene-XXXXXX").string();
  if (!mkdtemp(pattern.data())) throw std::runtime_error(fmt::format("{}: no temporary folder", pattern));
  return pattern;
}

void remove_folder(const std::string& folder) {
  std::error_code ignored;
  std::filesystem::remove_all(folder, ignored);
}

/// A message without the path of an image that will be gone: what the suite calls it stands in its place.
std::string without_path(std::string message, const std::string& path) {
  for (std::size_t at = 0; !path.empty() && (at = message.find(path, at)) != std::string::npos;)
    message.replace(at, path.size(), "{out}");
  return message;
}

std::string_view trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(" \t\r"), last = text.find_last_not_of(" \t\r");
  return first == std::string_view::npos ? "" : text.substr(first, last - first + 1);
}

/// Times that a command prints; lines that say something else are none of ours.
class PrintedTimes {
 public:
  void read(std::string_view line) {
    constexpr std::string_view label = "time_ms:";
    line = trimmed(line);
    if (!line.starts_with(label)) return;
    const std::string_view number = trimmed(line.substr(label.size()));
    double ms = 0.0;
    const auto [end, fault] = std::from_chars(number.data(), number.data() + number.size(), ms);
    const bool good = fault == std::errc() && end == number.data() + number.size() && std::isfinite(ms) && ms > 0.0;
    if (good) ms_.push_back(ms);
    else if (wrong_.empty()) wrong_ = line.substr(0, 80);
  }
  /// Throws std::runtime_error if a line held no time.
  const std::vector<double>& ms() const {
    if (!wrong_.empty())
      throw std::runtime_error(
          fmt::format("its command printed '{}'; expected `time_ms: ` and a positive number", wrong_));
    return ms_;
  }

 private:
  std::vector<double> ms_;
  std::string wrong_;
};

}  // namespace

ExportedScene::ExportedScene(const SceneContext& context) : folder_(new_folder()) {
  try {
    export_scene(context.animation(), context.frame(), folder_);
  } catch (...) {
    remove_folder(folder_);
    throw;
  }
}

ExportedScene::~ExportedScene() {
  remove_folder(folder_);
}

Checked check_external(const Variant& variant, const SceneContext& context, const Suite& suite,
                       std::optional<ExportedScene>& exported) {
  Checked c;
  c.row = empty_row(variant, context, suite);
  try {
    const External& external = *variant.external;
    if (!exported) exported.emplace(context);
    const std::string& folder = exported->folder();
    const std::string image = folder + "/image.exr";
    std::filesystem::remove(image);  // an earlier command's
    PrintedTimes times;
    const CommandEnd end = run_command(command_for(external, folder, image), external.folder, external.timeout_s,
                                       [&](std::string_view line) { times.read(line); });
    c.row.timing.command_ms = end.ms;
    if (const std::string fault = end.fault(); !fault.empty()) throw std::runtime_error("its command " + fault);
    if (!std::filesystem::exists(image))
      throw std::runtime_error("its command ended well, but wrote no image to {out}");
    c.image = load_foreign_image(image, context.frame().receivers, context.scene().name);
    c.row.timing.frame_ms = times.ms();
    c.row.timing.iterations = times.ms().empty() ? 0 : 1;
    c.row.score = context.score(c.image, variant.parameters);
  } catch (const std::exception& e) {
    c.row.status = "failed: " + without_path(e.what(), exported ? exported->folder() + "/image.exr" : "");
  }
  return c;
}

}  // namespace penumbra
