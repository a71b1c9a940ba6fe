#include "scenes/storage/atomic_write.h"

#include <fcntl.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <filesystem>
#include <fstream>
#include <system_error>

#include "scenes/storage/error.h"

namespace penumbra {
namespace {

namespace fs = std::filesystem;

std::string reason(int code) {
  return std::generic_category().message(code);
}

/// From the last dot on; empty if there is none, or too much behind it for an extension.
std::string extension_of(const std::string& name) {
  const std::size_t dot = name.rfind('.');
  return dot == std::string::npos || name.size() - dot > 16 ? "" : name.substr(dot);
}

/// An empty file of a name that nothing else has, left-overs of processes that were killed included.
std::string claim_beside(const fs::path& target) {
  static std::atomic<unsigned> calls{0};
  while (true) {
    const std::string name =
        fmt::format(".partial-{}-{}{}", getpid(), calls++, extension_of(target.filename().string()));
    std::string path = (target.parent_path() / name).string();
    const int file = open(path.c_str(), O_CREAT | O_EXCL | O_WRONLY | O_CLOEXEC, 0666);
    if (file >= 0) {
      close(file);
      return path;
    }
    if (errno != EEXIST) throw Error("{}: cannot be written ({})", target.string(), reason(errno));
  }
}

}  // namespace

void make_folder(const std::string& path) {
  std::error_code failure;
  fs::create_directories(path, failure);
  if (failure) throw Error("{}: cannot be made: {}", path, failure.message());
}

void write_atomically(const std::string& path, const std::function<void(const std::string& temporary)>& write) {
  const std::string temporary = claim_beside(path);
  std::error_code failure;
  try {
    write(temporary);
    fs::rename(temporary, path, failure);
    if (failure) throw Error("{}: cannot be written ({})", path, failure.message());
  } catch (...) {
    fs::remove(temporary, failure);
    throw;
  }
}

void write_atomically(const std::string& path, const std::function<void(std::ostream&)>& write) {
  write_atomically(path, [&](const std::string& temporary) {
    errno = 0;
    std::ofstream out(temporary, std::ios::binary);
    write(out);
    out.close();
    if (!out) throw Error("{}: cannot be written ({})", path, errno ? reason(errno) : "unknown reason");
  });
}

void write_atomically(const std::string& path, std::string_view bytes) {
  write_atomically(path, [&](std::ostream& out) { out.write(bytes.data(), std::streamsize(bytes.size())); });
}

}  // namespace penumbra
