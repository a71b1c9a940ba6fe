#include "harness/measure/progress.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cstdio>

namespace penumbra {

void say(const std::string& text) {
  std::fputs(text.c_str(), stderr);
  std::fflush(stderr);
}

Progress::Progress(int steps)
    : terminal_(isatty(STDERR_FILENO)), steps_(steps), start_(std::chrono::steady_clock::now()) {}

Progress::~Progress() {
  clear();
}

void Progress::clear() {
  if (terminal_) say("\r\033[K");
}

void Progress::step(const std::string& what) {
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  clear();
  if (terminal_) {
    const std::string left = done_ > 0 ? fmt::format(", about {:.0f} s left", seconds / done_ * (steps_ - done_)) : "";
    say(fmt::format("[{}/{}{}] {}", done_ + 1, steps_, left, what));
  } else {
    say(fmt::format("[{}/{}, {:.0f} s] {}\n", done_ + 1, steps_, seconds, what));
  }
  ++done_;
}

void Progress::share(const std::string& what, double share) {
  if (terminal_) {
    clear();
    say(fmt::format("{}, {:.0f} %", what, 100.0 * share));
  } else if (what != last_) {
    say(fmt::format("{}\n", what));
  }
  last_ = what;
}

void Progress::note(const std::string& text) {
  clear();
  say(fmt::format("{}\n", text));
}

void Progress::note_once(const std::string& text) {
  if (said_.insert(text).second) note(text);
}

}  // namespace penumbra
