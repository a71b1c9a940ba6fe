// Command lines that cannot be understood, explained in one line that leads on.
#pragma once

#include <string>

namespace CLI {
class App;
class ParseError;
}  // namespace CLI

namespace penumbra {

/// Throws Error if the first argument, unless it is an option, is no command: which one may be meant, or which command
/// takes what it names.
void expect_command(const CLI::App& app, const std::string& first);

/// What was wrong with the arguments of a command, what may be meant, and where to look.
std::string explained(const CLI::App& app, const CLI::ParseError& error);

}  // namespace penumbra
