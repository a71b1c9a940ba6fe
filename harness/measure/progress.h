// What a run is doing: one rewritten line with the time left on a terminal, plain lines elsewhere. Goes to stderr.
#pragma once

#include <chrono>
#include <set>
#include <string>

namespace penumbra {

/// Writes to stderr; that nobody can read it must not end a run.
void say(const std::string& text);

class Progress {
 public:
  explicit Progress(int steps = 0);
  ~Progress();
  /// A step begins; steps that take long relative to others make the estimate rough.
  void step(const std::string& what);
  /// How far one long piece of work is, share in [0, 1]: its own line on a terminal, a line per `what` elsewhere.
  void share(const std::string& what, double share);
  /// Something worth keeping on screen.
  void note(const std::string& text);
  /// The same, unless it has been said before.
  void note_once(const std::string& text);

 private:
  void clear();
  bool terminal_;
  int steps_, done_ = 0;
  std::string last_;
  std::set<std::string> said_;
  std::chrono::steady_clock::time_point start_;
};

}  // namespace penumbra
