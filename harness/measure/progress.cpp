#include "harness/measure/progress.h"

#include <fmt/format.h>
#include <pthread.h>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <system_error>

#include "harness/measure/interrupt.h"
#include "harness/results/text.h"
#include "scenes/scene_file.h"

namespace penumbra {
namespace {

constexpr const char* wipe = "\r\033[K";
constexpr double quiet = 2.0;                          // s: what is done by then says nothing
constexpr double on_terminal = 0.1, elsewhere = 10.0;  // s between lines
constexpr auto tick_time = std::chrono::milliseconds(500);

std::atomic<bool> line_on_stderr = false;  ///< is a progress line there, which a message has to clear away?

/// 0 if nobody knows.
int columns_of_stderr() {
  winsize size{};
  if (ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0) return size.ws_col;
  const char* columns = std::getenv("COLUMNS");
  return columns ? std::atoi(columns) : 0;
}

class MessageSink : public spdlog::sinks::stderr_color_sink_mt {
 public:
  void log(const spdlog::details::log_msg& message) override {
    if (line_on_stderr.exchange(false)) say(wipe);
    spdlog::sinks::stderr_color_sink_mt::log(message);
  }
};

}  // namespace

void say(const std::string& text) {
  std::fputs(text.c_str(), stderr);
  std::fflush(stderr);
}

Scene load_scene(const std::string& name_or_path, const SphereChoice& choice, Progress& progress) {
  progress.step("loading " + name_or_path);
  return load_scene(name_or_path, choice,
                    [&](const std::string& stage, double share) { progress.share(stage, share); });
}

std::shared_ptr<spdlog::logger> message_logger() {
  return std::make_shared<spdlog::logger>("penumbra", std::make_shared<MessageSink>());
}

ProgressOutput progress_on_stderr() {
  const bool terminal = isatty(STDERR_FILENO) == 1;
  const auto columns = [fallback = terminal ? 80 : 100] {
    const int known = columns_of_stderr();
    return known > 0 ? known : fallback;
  };
  const auto write = [terminal](const std::string& text) {
    say(text);
    line_on_stderr = terminal && !text.ends_with('\n') && !text.ends_with(wipe);
  };
  const auto seconds = [] {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
  };
  return {terminal, columns, write, seconds};
}

Progress::Progress(ProgressOutput output)
    : output_(std::move(output)), start_(output_.seconds()), step_start_(start_), part_start_(start_) {}

Progress::~Progress() {
  finish();
}

void Progress::finish() {
  stop_timer();
  const std::lock_guard guard(mutex_);
  finish_step();
  under_way_ = false, share_ = -1.0;
  step_.clear(), kind_.clear(), part_.clear();
  clear();
}

void Progress::expect(const std::string& kind, int steps, double guess) {
  const std::lock_guard guard(mutex_);
  Kind& known = kinds_[kind];
  known.left = steps;
  known.guess = guess;
}

void Progress::finish_step() {
  const auto at = kinds_.find(kind_);
  if (!under_way_ || at == kinds_.end()) return;
  Kind& kind = at->second;
  kind.spent += output_.seconds() - step_start_;
  ++kind.done;
}

void Progress::step(const std::string& what, const std::string& kind) {
  {
    const std::lock_guard guard(mutex_);
    finish_step();
    under_way_ = true;
    step_ = what, kind_ = kind;
    if (const auto at = kinds_.find(kind); at != kinds_.end()) at->second.left = std::max(0, at->second.left - 1);
    part_.clear(), share_ = -1.0;
    step_start_ = part_start_ = output_.seconds();
    draw();
  }
  start_timer();
}

void Progress::share(const std::string& what, double share) {
  {
    const std::lock_guard guard(mutex_);
    if (what != part_) part_start_ = output_.seconds();
    part_ = what, share_ = std::clamp(share, 0.0, 1.0);
    draw();
  }
  start_timer();
}

void Progress::share(double share) {
  this->share("", share);
}

/// Of the announced steps, and of the one under way: by its share, or by what its kind takes.
double Progress::seconds_left() const {
  double left = 0.0;
  for (const auto& [name, kind] : kinds_) left += kind.left * kind.mean();
  const auto at = kinds_.find(kind_);
  if (!under_way_ || at == kinds_.end()) return left;
  const double spent = output_.seconds() - step_start_;
  const bool share_of_step = share_ > 0.0 && part_.empty();
  return left + (share_of_step ? spent * (1.0 - share_) / share_ : std::max(0.0, at->second.mean() - spent));
}

std::string Progress::line() const {
  const double now = output_.seconds();
  std::string head, tail;
  const bool announced = kinds_.contains(kind_) ||
                         std::any_of(kinds_.begin(), kinds_.end(), [](const auto& k) { return k.second.left > 0; });
  if (announced) {
    const double left = seconds_left(), spent = now - start_;
    head = fmt::format("[{:.0f} %, {} left] ", 100.0 * spent / (spent + left), duration_text(left));
  }
  const double spent = now - part_start_;
  if (share_ >= 0.0) tail = fmt::format(", {:.0f} %", 100.0 * share_);
  else if (now - step_start_ >= quiet) tail = fmt::format(", {:.0f} s", now - step_start_);
  if (!announced && share_ > 0.02 && spent >= 1.0)
    tail += fmt::format(", {} left", duration_text(spent * (1.0 - share_) / share_));
  const std::string what = step_.empty() || part_.empty() ? step_ + part_ : step_ + ": " + part_;
  const int columns = output_.columns() - 1;  // some terminals begin a new line behind the last column
  const int room = columns - columns_of(head) - columns_of(tail);
  constexpr int least = 12;  // columns that still say something
  return room >= least ? head + cut_to_columns(what, room) + tail : cut_to_columns(head + what + tail, columns);
}

void Progress::draw() {
  const double now = output_.seconds();
  if (now - start_ < quiet || now - drawn_ < (output_.terminal ? on_terminal : elsewhere) || interrupted()) return;
  drawn_ = now;
  on_screen_ = output_.terminal;
  output_.write(output_.terminal ? wipe + line() : line() + "\n");
}

void Progress::clear() {
  if (on_screen_) output_.write(wipe);
  on_screen_ = false;
}

void Progress::note(const std::string& text) {
  const std::lock_guard guard(mutex_);
  clear();
  output_.write(text + "\n");
}

void Progress::note_once(const std::string& text) {
  bool fresh = false;
  {
    const std::lock_guard guard(mutex_);
    fresh = said_.insert(text).second;
  }
  if (fresh) note(text);
}

void Progress::start_timer() {
  const std::lock_guard guard(mutex_);
  if (timer_.joinable() || still_ > 0) return;
  stop_ = false;
  try {
    timer_ = std::thread([this] { tick(); });
  } catch (const std::system_error&) {  // no thread to be had: the line moves with the steps alone
  }
}

void Progress::stop_timer() {
  std::thread ending;
  {
    const std::lock_guard guard(mutex_);
    stop_ = true;
    ending.swap(timer_);
  }
  wake_.notify_all();
  if (ending.joinable()) ending.join();
}

void Progress::tick() {
  pthread_setname_np(pthread_self(), "progress");
  std::unique_lock lock(mutex_);
  while (!wake_.wait_for(lock, tick_time, [this] { return stop_; })) draw();
}

Progress::Still::Still(Progress& progress) : progress_(progress) {
  {
    const std::lock_guard guard(progress_.mutex_);
    ++progress_.still_;
  }
  progress_.stop_timer();
}

Progress::Still::~Still() {
  const std::lock_guard guard(progress_.mutex_);
  --progress_.still_;
}

}  // namespace penumbra
