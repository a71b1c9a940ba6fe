#include "scenes/scene_outline.h"

#include <filesystem>

#include "scenes/assets.h"
#include "scenes/toml_reader.h"

namespace penumbra {
namespace {

void outline_spheres(TomlReader& occluder, const SphereChoice& choice, SceneOutline& outline) {
  const toml::node* node = occluder.node("spheres");
  if (choice.count || (node && node->is_integer())) {
    outline.spheres += std::size_t(choice.count ? *choice.count : *occluder.integer("spheres", 1, 4096));
    outline.objective = choice.objective ? to_string(*choice.objective)
                                         : occluder.text("objective").value_or(to_string(FitRequest().objective));
  } else if (node && node->is_array()) {
    outline.spheres += node->as_array()->size();
  } else if (node && node->is_string()) {
    const auto path = std::filesystem::path(occluder.file()).parent_path() / *occluder.text("spheres");
    outline.spheres += read_spheres(path.string()).size();
  }
}

}  // namespace

SceneOutline read_outline(const std::string& name_or_path, const SphereChoice& choice) {
  SceneOutline outline;
  outline.file = shipped_file(name_or_path, "library");
  TomlReader file = TomlReader::open(outline.file);
  outline.name = read_name(file);
  outline.where = file.where("name");
  if (auto occluder = file.table("occluder")) outline_spheres(*occluder, choice, outline);
  for (TomlReader& entity : file.tables("entity")) outline_spheres(entity, choice, outline);
  if (auto light = file.table("light"))
    outline.environment = light->has("environment"), outline.lamps = light->has("area");
  return outline;
}

}  // namespace penumbra
