// How a comparison of two runs reads: on a screen, in a pull request, for other programs.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "harness/compare/comparison.h"

namespace penumbra {

/// "1 regression, 2 faster, 12 same": the verdict and how many rows have which.
std::string comparison_verdict(const Comparison& comparison);

/// At most 20 lines of so many columns: the verdict, what changed with the worst first, what has no partner, notes.
std::string make_comparison_screen(const Comparison& comparison, int width);

/// GitHub's Markdown: the verdict, a table of what changed, all other rows folded away.
std::string make_comparison_markdown(const Comparison& comparison);

/// Every row with all figures, what has no partner, notes, exit code.
nlohmann::json comparison_json(const Comparison& comparison);

/// For rows whose error changed and that have images: base, new and new - base (signed_error) side by side as
/// FOLDER/NAME.png; at most 20, what tells most first. `base` and `next`: folders of results. Returns the files.
std::vector<std::string> save_comparison_pictures(const Comparison& comparison, const std::string& base,
                                                  const std::string& next, const std::string& folder);

}  // namespace penumbra
