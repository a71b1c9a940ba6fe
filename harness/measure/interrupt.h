// Ctrl-C and SIGTERM: the first asks a run to stop and keeps what is finished, the second ends the program at once.
#pragma once

#include <functional>
#include <thread>

namespace penumbra {

/// Thrown by long work that stopped because it was asked to. No std::exception: it is nobody's failure.
struct Interrupted {};

/// Has the run been asked to stop?
bool interrupted();
/// Throws Interrupted if it has.
void stop_if_interrupted();

/// While it lives, signals ask instead of ending the program. `asked` is called at once, on a thread of its own. What
/// cannot stop (a technique's table, a fit) does not hold up the end: if the watch still lives after 1 s, `late` is
/// called on that thread, and the program ends with exit code 130.
class InterruptWatch {
 public:
  InterruptWatch(std::function<void()> asked, std::function<void()> late);
  ~InterruptWatch();
  InterruptWatch(const InterruptWatch&) = delete;
  InterruptWatch& operator=(const InterruptWatch&) = delete;

 private:
  void watch();
  std::function<void()> asked_, late_;
  std::thread thread_;
};

}  // namespace penumbra
