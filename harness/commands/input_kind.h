// What an argument is, whatever it was given for: a mesh in place of a suite leads to the command that takes meshes.
#pragma once

#include <string>

#include "techniques/registry.h"

namespace penumbra {

enum class InputKind { scene, suite, mesh, environment, technique, unknown };

/// Is `name` something of this kind? A file is known by its name and, if it is TOML, by its keys; any other name by
/// what is shipped, built in or registered, where several kinds may share one.
bool is_called(const std::string& name, InputKind kind, const Registry& registry);

/// "a mesh: `penumbra choose ...` finds ...": what a name is and the commands that take it; empty if it is unknown.
std::string what_it_is(const std::string& name, const Registry& registry);

/// Throws Error, saying which command is meant, if `name` is something else than a scene, or a suite. What is unknown
/// is left to whoever reads it.
void expect_scene(const std::string& name, const Registry& registry);
void expect_suite(const std::string& name, const Registry& registry);

}  // namespace penumbra
