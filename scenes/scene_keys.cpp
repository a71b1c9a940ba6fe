#include "scenes/scene_keys.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "scenes/assets.h"

namespace penumbra {

std::optional<dvec3> read_place(TomlReader& at, const std::string& key) {
  const auto v = at.point(key);
  if (v && glm::any(glm::greaterThan(glm::abs(*v), dvec3(huge))))
    at.fail(key, fmt::format("holds a number outside [{}, {}]", -huge, huge));
  return v;
}

std::optional<vec3> read_direction(TomlReader& at, const std::string& key) {
  const auto v = at.point(key);
  if (!v) return {};
  const double largest = std::max({std::abs(v->x), std::abs(v->y), std::abs(v->z)});
  if (largest == 0.0) at.fail(key, "must not be zero");
  return vec3(glm::normalize(*v / largest));
}

std::string exactly_one(TomlReader& at, const std::vector<std::string>& kinds) {
  std::vector<std::string> found;
  for (const auto& kind : kinds)
    if (at.has(kind)) found.push_back(kind);
  if (found.size() != 1)
    throw Error("{}: [{}] has {}; exactly one of {} is allowed", at.where(found.size() > 1 ? found[1] : ""),
                at.name("").substr(0, at.name("").size() - 1),
                found.empty() ? "no kind" : fmt::format("{}", fmt::join(found, " and ")), fmt::join(kinds, ", "));
  return found[0];
}

std::string resolve(const TomlReader& at, const std::string& key, const std::string& name, const std::string& kind,
                    const char* built_in) {
  if (std::string file = at_key(at, key, [&] { return asset_file(name, kind); }); !file.empty()) return file;
  const auto path = std::filesystem::path(at.file()).parent_path() / name;
  if (std::filesystem::exists(path)) return path.string();
  at.fail(key, fmt::format("is '{}': no such asset or file; allowed are the names {} and {}, or a path relative to "
                           "the scene file",
                           name, asset_names(kind), built_in));
}

}  // namespace penumbra
