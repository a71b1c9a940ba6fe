#include "harness/measure/progress.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cstdio>

namespace penumbra {

Progress::Progress(int steps)
    : terminal_(isatty(STDERR_FILENO)), steps_(steps), start_(std::chrono::steady_clock::now()) {}

Progress::~Progress() {
  clear();
}

void Progress::clear() {
  if (terminal_) fmt::print(stderr, "\r\033[K");
}

void Progress::step(const std::string& what) {
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  clear();
  if (terminal_) {
    const std::string left = done_ > 0 ? fmt::format(", about {:.0f} s left", seconds / done_ * (steps_ - done_)) : "";
    fmt::print(stderr, "[{}/{}{}] {}", done_ + 1, steps_, left, what);
    std::fflush(stderr);
  } else {
    fmt::print(stderr, "[{}/{}, {:.0f} s] {}\n", done_ + 1, steps_, seconds, what);
  }
  ++done_;
}

void Progress::share(const std::string& what, double share) {
  if (terminal_) {
    clear();
    fmt::print(stderr, "{}, {:.0f} %", what, 100.0 * share);
    std::fflush(stderr);
  } else if (what != last_) {
    fmt::print(stderr, "{}\n", what);
  }
  last_ = what;
}

void Progress::note(const std::string& text) {
  clear();
  fmt::print(stderr, "{}\n", text);
}

void Progress::note_once(const std::string& text) {
  if (said_.insert(text).second) note(text);
}

}  // namespace penumbra
