// What several parts of a scene file are read with. Throws as TomlReader does.
#pragma once

#include "scenes/toml_reader.h"

namespace penumbra {

constexpr double huge = 1e12;
constexpr double tiny = 1e-9;

/// A place or an edge. Farther out the square of a distance is no float.
std::optional<dvec3> read_place(TomlReader& at, const std::string& key);

/// A direction of any length but 0, as a unit vector: lengths that no float holds are fine.
std::optional<vec3> read_direction(TomlReader& at, const std::string& key);

/// The one key of `kinds` that is there.
std::string exactly_one(TomlReader& at, const std::vector<std::string>& kinds);

/// File of an asset name or of a path relative to the scene file; the key's place is put before whatever goes wrong.
std::string resolve(const TomlReader& at, const std::string& key, const std::string& name, const std::string& kind,
                    const char* built_in);

/// What `load` gives; the key's place is put before whatever goes wrong.
template <class Load>
auto at_key(const TomlReader& at, const std::string& key, Load load) {
  try {
    return load();
  } catch (const Error& e) {
    throw Error("{}: key '{}': {}", at.where(key), at.name(key), e.what());
  }
}

}  // namespace penumbra
