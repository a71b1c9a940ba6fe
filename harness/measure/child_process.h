// Other people's programs: they may hang, crash, print without end, or leave children behind.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <string_view>

namespace penumbra {

/// A word of /bin/sh, in quotes where it needs them.
std::string shell_word(const std::string& word);

/// How a command ended.
struct CommandEnd {
  int status = 0;          ///< as waitpid() tells it
  bool timed_out = false;  ///< it was killed because its time was up
  double ms = 0.0;         ///< wall time from start to end
  std::string last_words;  ///< the last line on its standard error, at most 200 bytes of text

  /// "" if it ended well; else "ended with exit code 3: last words", "crashed (signal 11, ...)", "did not end in time".
  std::string fault() const;
};

/// Runs a command of /bin/sh in a folder, without input, and waits until it ends. `line` gets every line of its
/// standard output (of a longer one than 4096 bytes, its begin). After `seconds`, and when this program is interrupted,
/// it is killed with all of its process group, as it is when this program dies. Throws Interrupted, or
/// std::runtime_error if there is no process to run it in.
CommandEnd run_command(const std::string& command, const std::string& folder, double seconds,
                       const std::function<void(std::string_view)>& line);

/// A program that answers a line on its standard input with a line on its standard output. It is killed with all of its
/// process group when this is destroyed, and when this program dies.
class Conversation {
 public:
  /// Starts a command of /bin/sh in a folder. Throws std::runtime_error if there is no process to run it in.
  Conversation(const std::string& command, const std::string& folder);
  ~Conversation();
  Conversation(const Conversation&) = delete;
  Conversation& operator=(const Conversation&) = delete;

  /// The next line, which may be long. Throws std::runtime_error saying how the program ended, or that it did not
  /// answer within `seconds`; Interrupted.
  std::string listen(double seconds);
  /// Sends a line, and listens.
  std::string ask(const std::string& line, double seconds);

 private:
  class Child;
  std::unique_ptr<Child> child_;
};

}  // namespace penumbra
