#include "harness/measure/interrupt.h"

#include <semaphore.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <ctime>

namespace penumbra {
namespace {

volatile std::sig_atomic_t asked = 0;
std::atomic<bool> over = false;  // the watch is about to go
sem_t news;                      // of a signal or of the end: the only thing that a signal handler may tell a thread

void ask(int) {
  asked = 1;
  std::signal(SIGINT, SIG_DFL);  // the next one, of either kind, ends the program
  std::signal(SIGTERM, SIG_DFL);
  sem_post(&news);
}

void wait_for_news() {
  while (sem_wait(&news) != 0 && errno == EINTR) {
  }
}

/// False if nothing came within the time.
bool wait_for_news(long milliseconds) {
  timespec until;
  clock_gettime(CLOCK_REALTIME, &until);
  until.tv_nsec += milliseconds % 1000 * 1000000;
  until.tv_sec += milliseconds / 1000 + until.tv_nsec / 1000000000;
  until.tv_nsec %= 1000000000;
  while (sem_timedwait(&news, &until) != 0)
    if (errno != EINTR) return false;
  return true;
}

constexpr long patience = 1000;  // ms

}  // namespace

bool interrupted() {
  return asked != 0;
}

void stop_if_interrupted() {
  if (interrupted()) throw Interrupted();
}

InterruptWatch::InterruptWatch(std::function<void()> asked_now, std::function<void()> late)
    : asked_(std::move(asked_now)), late_(std::move(late)) {
  asked = 0, over = false;
  sem_init(&news, 0, 0);
  thread_ = std::thread([this] { watch(); });
  std::signal(SIGPIPE, SIG_IGN);  // whoever read our messages may have gone with the same Ctrl-C
  std::signal(SIGINT, ask);
  std::signal(SIGTERM, ask);
}

InterruptWatch::~InterruptWatch() {
  std::signal(SIGINT, SIG_DFL);
  std::signal(SIGTERM, SIG_DFL);
  std::signal(SIGPIPE, SIG_DFL);
  over = true;
  sem_post(&news);
  thread_.join();
  sem_destroy(&news);
}

void InterruptWatch::watch() {
  wait_for_news();
  if (over) return;
  asked_();
  if (wait_for_news(patience) && over) return;
  late_();
  std::fflush(nullptr);
  _exit(130);
}

}  // namespace penumbra
