// How the program presents itself: its first screen, and the help of every command.
#pragma once

#include <string>

namespace CLI {
class App;
}

namespace penumbra {

/// Gives a program, and the commands that are added to it afterwards, help that fits the screen. The program's own help
/// is the first screen: where to begin, and every command.
void format_help(CLI::App& app);

/// Where to begin, and every command.
std::string first_screen(const CLI::App& app);

/// What this program is: version, commit, compiler, instruction sets, CUDA or why not.
std::string version_text();

}  // namespace penumbra
