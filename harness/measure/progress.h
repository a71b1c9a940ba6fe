// What a command is doing: what, how far, time left. One rewritten line on a terminal, a line every ten seconds
// elsewhere, nothing for what is done within two seconds. Goes to stderr.
#pragma once

#include <condition_variable>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <thread>

namespace spdlog {
class logger;
}

namespace penumbra {

struct Scene;
struct SphereChoice;

/// Writes to stderr; that nobody can read it must not end a run.
void say(const std::string& text);

/// Where progress is written, and what time it is there.
struct ProgressOutput {
  bool terminal = false;
  std::function<int()> columns;                   ///< a line is narrower than this
  std::function<void(const std::string&)> write;  ///< must not throw
  std::function<double()> seconds;                ///< a clock that never goes back
};

/// Progress on stderr, by the steady clock.
ProgressOutput progress_on_stderr();

/// All functions may be called from any thread. While a step or a share is under way, a timer thread redraws the line.
class Progress {
 public:
  explicit Progress(ProgressOutput output = progress_on_stderr());
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// So many steps of a kind are left, the one under way not counted. Time left is estimated from how long steps of the
  /// same kind took; before one is over, `guess` (seconds) stands in.
  void expect(const std::string& kind, int steps, double guess);
  /// A step begins, and the one before is over. `kind`: as announced.
  void step(const std::string& what, const std::string& kind = "");
  /// How far the step is, share in [0, 1]. `what` says what the share is of, if not of the whole step.
  void share(const std::string& what, double share);
  void share(double share);
  /// Nothing is under way any more: the line goes.
  void finish();
  /// Something worth keeping on screen.
  void note(const std::string& text);
  /// As note(), unless it has been said before.
  void note_once(const std::string& text);

  /// While this lives, no timer thread does: frames are being timed. What is called shows as ever.
  class Still {
   public:
    explicit Still(Progress& progress);
    ~Still();
    Still(const Still&) = delete;
    Still& operator=(const Still&) = delete;

   private:
    Progress& progress_;
  };

 private:
  struct Kind {
    int left = 0, done = 0;
    double spent = 0.0, guess = 0.0;  ///< seconds, of all that are done; of one
    double mean() const { return done ? spent / done : guess; }
  };
  void finish_step();
  double seconds_left() const;
  std::string line() const;
  void draw();
  void clear();
  void start_timer();
  void stop_timer();
  void tick();

  const ProgressOutput output_;
  const double start_;
  std::mutex mutex_;
  std::map<std::string, Kind> kinds_;
  bool under_way_ = false;   ///< is there a step?
  std::string step_, kind_;  ///< what it is
  std::string part_;         ///< what `share_` is of, if not of the step
  double share_ = -1.0;      ///< unknown below 0
  double step_start_, part_start_;
  double drawn_ = -1e9;     ///< seconds of the clock
  bool on_screen_ = false;  ///< is there a line to be cleared?
  std::set<std::string> said_;

  std::thread timer_;
  std::condition_variable wake_;
  bool stop_ = false;
  int still_ = 0;
};

/// load_scene() as a step of its own; the fit that it may need tells how far it is.
Scene load_scene(const std::string& name_or_path, const SphereChoice& choice, Progress& progress);

/// Messages to stderr, in place of the progress line if there is one.
std::shared_ptr<spdlog::logger> message_logger();

}  // namespace penumbra
