// Techniques that live in other programs: [[external]] of a suite, and images that are scored from their files.
#pragma once

#include <memory>
#include <string>

#include "techniques/registry.h"

namespace penumbra {

struct External {
  Entry entry;          ///< its name; it makes no technique
  std::string command;  ///< of /bin/sh, with {scene} and {out}; empty: the image is there already
  std::string folder;   ///< that the command runs in
  double timeout_s = 600.0;
};

/// `reads_spheres`: may the image depend on the scene's spheres? If not, one choice of them is enough.
std::shared_ptr<const External> make_external(const std::string& name, const std::string& command = "",
                                              const std::string& folder = ".", double timeout_s = 600.0,
                                              bool reads_spheres = true);

/// A row's key, with the command and the content of the files that it names: what makes the image.
std::string external_key(const External& external, const std::string& key);

/// The command for one scene: {scene} and {out} replaced by these paths, quoted where the shell wants it.
std::string command_for(const External& external, const std::string& scene_folder, const std::string& image_file);

}  // namespace penumbra
