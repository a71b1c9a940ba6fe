// Names that become names of files and folders.
#pragma once

#include <string>

namespace penumbra {

/// Longest name of a scene or suite, bytes: with everything that is put behind it (spheres, objective) a file name
/// stays under the 255 bytes of most file systems.
inline constexpr std::size_t longest_name = 200;

/// What forbids a name of a scene or suite, and what is allowed, on one line; empty if nothing does. Text in any script
/// is fine; what would leave the folder, hide in it or break a line of a table is not.
std::string name_fault(const std::string& name);

/// The name with '/', ':' and ' ' as '-': one part of a path.
std::string file_name(std::string name);

/// file_name() in lower case: equal for names that could be the same file somewhere.
std::string file_name_key(const std::string& name);

}  // namespace penumbra
