#include "scenes/scene_outline.h"

#include <filesystem>

#include "scenes/assets.h"
#include "scenes/entities_file.h"
#include "scenes/toml_reader.h"

namespace penumbra {
namespace {

void outline_spheres(TomlReader& entity, const SphereChoice& choice, SceneOutline& outline,
                     JoinedObjective& objective) {
  const toml::node* node = entity.node("spheres");
  std::size_t spheres = 0;
  std::string fitted_for;
  if (choice.count || (node && node->is_integer())) {
    spheres = std::size_t(choice.count ? *choice.count : *entity.integer("spheres", 1, 4096));
    fitted_for = choice.objective ? to_string(*choice.objective)
                                  : entity.text("objective").value_or(to_string(FitRequest().objective));
  } else if (node && node->is_array()) {
    spheres = node->as_array()->size();
  } else if (node && node->is_string()) {
    const auto path = std::filesystem::path(entity.file()).parent_path() / *entity.text("spheres");
    spheres = read_spheres(path.string()).size();
  }
  if (spheres > 0) objective.add(fitted_for);
  outline.spheres += spheres;
}

}  // namespace

SceneOutline read_outline(const std::string& name_or_path, const SphereChoice& choice) {
  SceneOutline outline;
  outline.file = shipped_file(name_or_path, "library");
  TomlReader file = TomlReader::open(outline.file);
  outline.name = read_name(file);
  outline.where = file.where("name");
  JoinedObjective objective;
  if (auto occluder = file.table("occluder")) outline_spheres(*occluder, choice, outline, objective);
  std::vector<TomlReader> entities = file.tables("entity");
  const std::vector<SphereChoice> choices = choices_of(entities, choice);
  for (std::size_t k = 0; k < entities.size(); ++k) outline_spheres(entities[k], choices[k], outline, objective);
  outline.objective = objective.name();
  if (auto light = file.table("light"))
    outline.environment = light->has("environment"), outline.lamps = light->has("area");
  return outline;
}

}  // namespace penumbra
