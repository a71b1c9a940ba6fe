#include "harness/measure/child_process.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <deque>
#include <stdexcept>
#include <utility>

#include "harness/measure/interrupt.h"

namespace penumbra {
namespace {

class Descriptor {
 public:
  explicit Descriptor(int number = -1) : number_(number) {}
  Descriptor(Descriptor&& other) noexcept : number_(std::exchange(other.number_, -1)) {}
  Descriptor& operator=(Descriptor&& other) noexcept {
    std::swap(number_, other.number_);
    return *this;
  }
  ~Descriptor() { reset(); }
  void reset() {
    if (number_ >= 0) close(number_);
    number_ = -1;
  }
  int get() const { return number_; }

 private:
  int number_;
};

struct Pipe {
  Descriptor read, write;
};

Pipe make_pipe() {
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0) throw std::runtime_error(fmt::format("no pipe to a command ({})", strerror(errno)));
  fcntl(ends[0], F_SETFL, O_NONBLOCK);
  return {Descriptor(ends[0]), Descriptor(ends[1])};
}

/// Cuts what comes out of a pipe into lines.
class Lines {
 public:
  /// Of a line longer than `longest` bytes, its begin is told.
  Lines(Descriptor from, std::function<void(std::string_view)> line, std::size_t longest = 4096)
      : from_(std::move(from)), line_(std::move(line)), longest_(longest) {}
  int descriptor() const { return from_.get(); }

  /// Takes what is there without waiting.
  void take() {
    char bytes[4096];
    while (from_.get() >= 0) {
      const ssize_t count = read(from_.get(), bytes, sizeof bytes);
      if (count < 0 && errno == EINTR) continue;
      if (count < 0 && errno == EAGAIN) return;
      if (count <= 0) return from_.reset();
      for (ssize_t k = 0; k < count; ++k) add(bytes[k]);
    }
  }
  /// The last line needs no end.
  void finish() {
    take();
    if (!text_.empty()) line_(text_);
  }

 private:
  void add(char c) {
    if (c != '\n') {
      if (text_.size() < longest_) text_ += c;
      return;
    }
    line_(text_);
    text_.clear();
  }
  Descriptor from_;
  std::function<void(std::string_view)> line_;
  std::size_t longest_;
  std::string text_;
};

/// Between fork and exec; nothing here may take a lock that another thread could have held. `in` below 0: no input.
[[noreturn]] void become(const char* command, const char* folder, int in, int out, int err) {
  setpgid(0, 0);
  for (const int signal : {SIGINT, SIGTERM, SIGPIPE}) std::signal(signal, SIG_DFL);
  sigset_t none;
  sigemptyset(&none);
  sigprocmask(SIG_SETMASK, &none, nullptr);
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (in < 0) in = open("/dev/null", O_RDONLY);
  if (in < 0 || dup2(in, 0) < 0 || dup2(out, 1) < 0 || dup2(err, 2) < 0 || chdir(folder) != 0) _exit(126);
  execl("/bin/sh", "sh", "-c", command, nullptr);
  _exit(127);
}

/// A child, its children, and the end of them all.
class Group {
 public:
  explicit Group(pid_t leader) : leader_(leader), exit_(int(syscall(SYS_pidfd_open, leader, 0))) {
    setpgid(leader, leader);
  }
  Group(const Group&) = delete;
  Group& operator=(const Group&) = delete;
  ~Group() {
    if (!reaped_) reap();
  }
  int descriptor() const { return exit_.get(); }

  bool ended() const {
    siginfo_t info = {};
    return waitid(P_PID, id_t(leader_), &info, WEXITED | WNOHANG | WNOWAIT) != 0 || info.si_pid == leader_;
  }
  void kill_all() const { kill(-leader_, SIGKILL); }
  /// Kills what is left, and tells how the leader ended.
  int reap() {
    kill_all();  // before its number is free for another
    int status = 0;
    while (waitpid(leader_, &status, 0) < 0 && errno == EINTR) {
    }
    reaped_ = true;
    return status;
  }

 private:
  pid_t leader_;
  Descriptor exit_;
  bool reaped_ = false;
};

std::string one_line(std::string_view text) {
  std::string line(text.substr(0, 200));
  for (char& c : line)
    if (static_cast<unsigned char>(c) < ' ') c = ' ';
  return line;
}

}  // namespace

std::string shell_word(const std::string& word) {
  const char* plain = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_./-+";
  if (!word.empty() && word.find_first_not_of(plain) == std::string::npos) return word;
  std::string text = "'";
  for (const char c : word) text += c == '\'' ? "'\\''" : std::string(1, c);
  return text + "'";
}

std::string CommandEnd::fault() const {
  const std::string words = last_words.empty() ? "" : ": " + last_words;
  if (timed_out) return fmt::format("did not end within {:.3g} s{}", 1e-3 * ms, words);
  if (WIFSIGNALED(status))
    return fmt::format("crashed (signal {}, {}){}", WTERMSIG(status), strsignal(WTERMSIG(status)), words);
  return WEXITSTATUS(status) == 0 ? "" : fmt::format("ended with exit code {}{}", WEXITSTATUS(status), words);
}

CommandEnd run_command(const std::string& command, const std::string& folder, double seconds,
                       const std::function<void(std::string_view)>& line) {
  using Time = std::chrono::duration<double, std::milli>;
  Pipe out = make_pipe(), err = make_pipe();
  const auto start = std::chrono::steady_clock::now();
  const auto passed = [&] { return Time(std::chrono::steady_clock::now() - start).count(); };
  const pid_t child = fork();
  if (child < 0) throw std::runtime_error(fmt::format("no process to run a command in ({})", strerror(errno)));
  if (child == 0) become(command.c_str(), folder.c_str(), -1, out.write.get(), err.write.get());
  Group group(child);
  out.write.reset(), err.write.reset();
  CommandEnd end;
  Lines said(std::move(out.read), line);
  Lines complained(std::move(err.read), [&](std::string_view text) {
    if (std::string words = one_line(text); words.find_first_not_of(' ') != std::string::npos)
      end.last_words = std::move(words);
  });
  while (!group.ended()) {
    stop_if_interrupted();
    if (!end.timed_out && passed() > 1e3 * seconds) {
      end.timed_out = true;
      group.kill_all();
    }
    pollfd news[] = {
        {said.descriptor(), POLLIN, 0}, {complained.descriptor(), POLLIN, 0}, {group.descriptor(), POLLIN, 0}};
    poll(news, 3, 20);
    said.take(), complained.take();
  }
  end.ms = passed();
  end.status = group.reap();
  said.finish(), complained.finish();
  return end;
}

class Conversation::Child {
 public:
  Child(pid_t leader, Descriptor in, Pipe out, Pipe err)
      : group_(leader),
        in_(std::move(in)),
        said_(
            std::move(out.read), [this](std::string_view line) { lines_.emplace_back(line); }, std::size_t(1) << 30),
        complained_(std::move(err.read), [this](std::string_view text) { last_words_ = one_line(text); }) {}

  void send(const std::string& line) {
    const std::string text = line + "\n";
    for (std::size_t sent = 0; sent < text.size();) {
      const ssize_t count = ::send(in_.get(), text.data() + sent, text.size() - sent, MSG_NOSIGNAL);
      if (count < 0 && errno == EINTR) continue;
      if (count <= 0) return;  // it has ended, which listen() tells
      sent += std::size_t(count);
    }
  }

  std::string listen(double seconds) {
    using Seconds = std::chrono::duration<double>;
    const auto start = std::chrono::steady_clock::now();
    while (lines_.empty()) {
      const bool ended = !fault_.empty() || group_.ended();  // before the last look at what it said
      stop_if_interrupted();
      pollfd news[] = {
          {said_.descriptor(), POLLIN, 0}, {complained_.descriptor(), POLLIN, 0}, {group_.descriptor(), POLLIN, 0}};
      if (!ended) poll(news, 3, 20);
      said_.take(), complained_.take();
      const double passed = Seconds(std::chrono::steady_clock::now() - start).count();
      if (ended && lines_.empty()) throw std::runtime_error(fault());
      if (passed > seconds) throw std::runtime_error(fmt::format("did not answer within {:.3g} s", seconds));
    }
    std::string line = std::move(lines_.front());
    lines_.pop_front();
    return line;
  }

 private:
  std::string fault() {
    if (!fault_.empty()) return fault_;
    CommandEnd end;
    end.status = group_.reap();
    end.last_words = last_words_;
    fault_ = end.fault();
    if (fault_.empty()) fault_ = "ended without an answer";
    return fault_;
  }

  Group group_;
  Descriptor in_;
  std::deque<std::string> lines_;
  std::string last_words_, fault_;
  Lines said_, complained_;
};

Conversation::Conversation(const std::string& command, const std::string& folder) {
  int in[2];  // a socket can be written to without a signal if nobody reads
  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, in) != 0)
    throw std::runtime_error(fmt::format("no connection to a command ({})", strerror(errno)));
  Descriptor ours(in[0]), theirs(in[1]);
  Pipe out = make_pipe(), err = make_pipe();
  const pid_t child = fork();
  if (child < 0) throw std::runtime_error(fmt::format("no process to run a command in ({})", strerror(errno)));
  if (child == 0) become(command.c_str(), folder.c_str(), theirs.get(), out.write.get(), err.write.get());
  theirs.reset(), out.write.reset(), err.write.reset();
  child_ = std::make_unique<Child>(child, std::move(ours), std::move(out), std::move(err));
}

Conversation::~Conversation() = default;

std::string Conversation::listen(double seconds) {
  return child_->listen(seconds);
}

std::string Conversation::ask(const std::string& line, double seconds) {
  child_->send(line);
  return child_->listen(seconds);
}

}  // namespace penumbra
