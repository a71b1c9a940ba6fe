// Files that are whole or not there.
#pragma once

#include <functional>
#include <ostream>
#include <string>
#include <string_view>

namespace penumbra {

/// Makes a folder and those above it. Throws Error naming it and the reason if it cannot be made.
void make_folder(const std::string& path);

/// Has a file written under another name in the same folder, and then gives it its own in one step: whoever looks finds
/// the file before or the file after, whole. No other call, of this process or another, writes under that name; it has
/// the same extension and is short, so `path` may be as long as the file system allows. Whatever is thrown on the way
/// leaves neither of the two behind. Throws Error naming `path` and the reason.
void write_atomically(const std::string& path, const std::function<void(const std::string& temporary)>& write);

/// Writes what `write` sends to a stream, whole or not at all. Throws Error naming `path` and the reason.
void write_atomically(const std::string& path, const std::function<void(std::ostream&)>& write);

/// Writes text or bytes, whole or not at all. Throws Error naming `path` and the reason.
void write_atomically(const std::string& path, std::string_view bytes);

}  // namespace penumbra
