// Text for a screen: how wide that is, and lines that fit it.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace penumbra {

/// Columns of the terminal behind a file descriptor: $COLUMNS, else what the terminal says. Empty where neither is
/// known, as in a pipe.
std::optional<int> terminal_width(int descriptor);

/// Columns that stdout's screens keep to: those of the terminal, at least 40 and at most 100; 100 where they are
/// unknown.
int screen_width();

/// `text` broken at spaces so that no line exceeds `width` columns, unless one word does. Line breaks in it are kept.
/// Lines after the first begin with `indent` spaces, the first one stands behind `start` columns of something else. No
/// line break at the end.
std::string wrapped(const std::string& text, int width, int indent = 0, int start = 0);

/// "  label   text": the text begins at `column` and is wrapped there; after a longer label it begins on a line of its
/// own. Ends with a line break.
std::string labelled(const std::string& label, const std::string& text, int column, int width);

/// A row's label with spaces for its slashes, so that it can be broken into lines.
std::string spaced(std::string label);

}  // namespace penumbra
