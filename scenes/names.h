// Names that become names of files and folders.
#pragma once

#include <string>

namespace penumbra {

/// Of a scene or suite, in bytes: with everything that is put behind it (spheres, objective) or before it (`.partial-`)
/// a file name stays under the 255 bytes of most file systems.
inline constexpr std::size_t longest_name = 200;

/// What forbids a name of a scene or suite, and what is allowed, on one line; empty if nothing does. Text in any script
/// is fine; what would leave the folder, hide in it or break a line of a table is not.
std::string name_fault(const std::string& name);

/// The name with '/', ':' and ' ' as '-': one part of a path.
std::string file_name(std::string name);

/// Equal for names that could be the same file somewhere: file_name(), without upper and lower case.
std::string file_name_key(const std::string& name);

}  // namespace penumbra
