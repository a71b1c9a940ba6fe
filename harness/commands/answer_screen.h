// What `penumbra choose` says of its answer: one screen, and the same as JSON.
#pragma once

#include <nlohmann/json.hpp>

#include "harness/choose/answer.h"

namespace penumbra {

/// A screen of at most `width` columns and 25 lines, the verdict first.
std::string screen_of(const Answer& answer, int width);
/// All of an answer, for programs.
nlohmann::json to_json(const Answer& answer);

/// The command that renders the best option, or else the nearest, with '\x1f' where it must not be broken; empty if
/// nothing was found.
std::string render_line(const Answer& answer);

}  // namespace penumbra
