// What `list NAME` and `help technique NAME` say of one technique, scene or suite.
#pragma once

#include <string>

#include "techniques/registry.h"

namespace penumbra {

/// Summary, citation, lights, backends and why one is not available, parameters with defaults, ranges, units and
/// meaning, the shipped suites that measure it, and a command that renders with it. Throws Error for other names.
std::string describe_technique(const std::string& name, const Registry& registry, int width);

/// Mesh, spheres, receivers, light and motion of a scene, which is loaded without its fit. Throws Error.
std::string describe_scene(const std::string& name_or_path, int width);

/// Scenes, spheres, settings and rows of a suite. Throws Error.
std::string describe_suite(const std::string& name_or_path, const Registry& registry, int width);

/// The names of techniques in order of their registration, each once.
std::vector<std::string> technique_names(const Registry& registry);

/// "scalar, simd, cuda (not here)": of one technique.
std::string backends_of(const std::string& technique, const Registry& registry);

/// "environments and lamps": what a technique can shade with.
std::string lights_of(const LightKinds& lights);

}  // namespace penumbra
