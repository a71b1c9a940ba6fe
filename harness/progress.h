// What a run is doing: one rewritten line with the time left on a terminal, plain lines elsewhere. Goes to stderr.
#pragma once

#include <chrono>
#include <string>

namespace penumbra {

class Progress {
 public:
  explicit Progress(int steps);
  ~Progress();
  /// A step begins; steps that take long relative to others make the estimate rough.
  void step(const std::string& what);
  /// Something worth keeping on screen.
  void note(const std::string& text);

 private:
  void clear();
  bool terminal_;
  int steps_, done_ = 0;
  std::chrono::steady_clock::time_point start_;
};

}  // namespace penumbra
