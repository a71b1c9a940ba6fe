// A child process for readers of other people's files: what a library crashes on must not end the program.
#pragma once

#include <cstddef>
#include <cstring>
#include <functional>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

namespace penumbra {

/// Sanitizers reserve terabytes of address space and install handlers of their own.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
inline constexpr bool sanitized = true;
#elif defined(__has_feature)
inline constexpr bool sanitized = __has_feature(address_sanitizer) || __has_feature(thread_sanitizer);
#else
inline constexpr bool sanitized = false;
#endif

/// The child's side: arrays for the parent, in order, and lines for its log. The child must not log by itself: another
/// thread may have held the logger's lock when the process was forked.
class Outbox {
 public:
  explicit Outbox(int file) : file_(file) {}
  template <class T>
  void put(const std::vector<T>& values) {
    static_assert(std::is_trivially_copyable_v<T> && alignof(T) <= 16);
    write(data, values.data(), values.size() * sizeof(T));
  }
  void warn(const std::string& line) { write(warning, line.data(), line.size()); }
  void info(const std::string& line) { write(information, line.data(), line.size()); }

  enum Kind : std::uint64_t { data = 1, warning, information, failure, end };
  void write(Kind kind, const void* bytes, std::size_t size);

 private:
  int file_;
};

/// The parent's side: the child's arrays in the order in which they were put, in a memory file that both map.
class Inbox {
 public:
  Inbox() = default;
  Inbox(Inbox&& other) noexcept { *this = std::move(other); }
  Inbox& operator=(Inbox&& other) noexcept {
    std::swap(mapping_, other.mapping_), std::swap(size_, other.size_);
    arrays_.swap(other.arrays_), std::swap(next_, other.next_);
    return *this;
  }
  ~Inbox();
  template <class T>
  std::vector<T> take() {
    const std::span<const std::byte> bytes = next();
    std::vector<T> values(bytes.size() / sizeof(T));
    if (!values.empty()) std::memcpy(static_cast<void*>(values.data()), bytes.data(), values.size() * sizeof(T));
    return values;
  }
  /// The next array without a copy; it lives as long as the inbox, aligned to 16 bytes.
  std::span<const std::byte> next();

 private:
  friend Inbox guarded(const std::string&, const std::string&, const std::function<void(Outbox&)>&, double);
  void* mapping_ = nullptr;
  std::size_t size_ = 0, next_ = 0;
  std::vector<std::span<const std::byte>> arrays_;
};

/// Seconds after which a reader of a file of `bytes` is taken to hang: generous, for slow and busy machines.
double time_limit(std::size_t bytes);

/// Runs `read` in a child process and hands over what it puts. What it throws is thrown here as an Error with the same
/// text; a crash, memory that runs out (4 GiB and 200 times the file) and a time over `seconds` (0: time_limit of the
/// file) become Errors that name `path` and end with `mend`, the way out. Lines for the log are logged here, once.
/// Safe beside other threads as long as `read` starts from nothing they may hold: no logger, no pool of threads.
Inbox guarded(const std::string& path, const std::string& mend, const std::function<void(Outbox&)>& read,
              double seconds = 0.0);

}  // namespace penumbra
