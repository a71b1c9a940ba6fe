// --frame, of commands that make or look at one image.
#pragma once

#include <CLI/CLI.hpp>
#include <optional>

namespace penumbra {

inline void add_frame_option(CLI::App& command, std::optional<int>& frame) {
  command.add_option("--frame", frame, "Of a scene that moves (default: the one that `run` scores)");
}

}  // namespace penumbra
