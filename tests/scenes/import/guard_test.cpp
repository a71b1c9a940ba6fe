#include "scenes/import/guard.h"

#include <gmock/gmock.h>
#include <spdlog/spdlog.h>
#include <sys/wait.h>

#include <atomic>
#include <csignal>
#include <thread>

#include "scenes/error.h"
#include "tests/support.h"

namespace penumbra {
namespace {

using testing::AllOf;
using testing::HasSubstr;

const std::string mend = "save it again";

std::string error_of(const std::function<void(Outbox&)>& read, double seconds = 0.0) {
  return test::error_of([&] { guarded("a.mesh", mend, read, seconds); });
}

void expect_no_child() {
  EXPECT_EQ(waitpid(-1, nullptr, WNOHANG), -1);
  EXPECT_EQ(errno, ECHILD) << "no zombie is left";
}

TEST(Guard, HandsOverArraysInOrder) {
  Inbox box = guarded("a.mesh", mend, [](Outbox& out) {
    out.put(std::vector<double>{1.5, 2.5, 3.5});
    out.put(std::vector<char>{'a', 'b', 'c', 'd', 'e'});
    out.put(std::vector<int>());
    out.put(std::vector<int>(50'000'000, 7));
  });
  EXPECT_EQ(box.take<double>(), (std::vector<double>{1.5, 2.5, 3.5}));
  EXPECT_EQ(box.take<char>(), (std::vector<char>{'a', 'b', 'c', 'd', 'e'}));
  EXPECT_TRUE(box.take<int>().empty());
  const auto bytes = box.next();
  ASSERT_EQ(bytes.size(), 200'000'000u);
  EXPECT_EQ(reinterpret_cast<std::uintptr_t>(bytes.data()) % 16, 0u);
  EXPECT_EQ(reinterpret_cast<const int*>(bytes.data())[49'999'999], 7);
  EXPECT_THROW(box.next(), std::logic_error);
  expect_no_child();
}

TEST(Guard, ErrorsComeOverAsTheyAre) {
  EXPECT_EQ(error_of([](Outbox&) { throw Error("a.mesh:7: no such vertex"); }), "a.mesh:7: no such vertex");
  EXPECT_THAT(error_of([](Outbox&) { throw std::runtime_error("odd"); }),
              AllOf(HasSubstr("a.mesh: "), HasSubstr("odd"), HasSubstr(mend)));
  EXPECT_THAT(error_of([](Outbox&) { throw 3; }), AllOf(HasSubstr("a.mesh: "), HasSubstr(mend)));
  EXPECT_THAT(error_of([](Outbox&) { throw std::bad_alloc(); }),
              AllOf(HasSubstr("a.mesh: "), HasSubstr("memory"), HasSubstr(mend)));
  expect_no_child();
}

TEST(Guard, CrashesBecomeErrors) {
  for (const int signal : {SIGSEGV, SIGABRT, SIGFPE, SIGKILL})
    EXPECT_THAT(error_of([&](Outbox&) { std::raise(signal); }),
                AllOf(HasSubstr("a.mesh: the importer crashed ("), HasSubstr(mend)))
        << signal;
  EXPECT_THAT(error_of([](Outbox& out) { out.put(std::vector<int>(100)), std::raise(SIGKILL); }),
              HasSubstr("signal 9, Killed"))
      << "after a part of the result";
  EXPECT_THAT(error_of([](Outbox&) { _exit(3); }), HasSubstr("exit code 3"));
  EXPECT_THAT(error_of([](Outbox&) { std::terminate(); }), HasSubstr("signal 6"));
  expect_no_child();
}

TEST(Guard, EndlessLoopsAreEnded) {
  EXPECT_THAT(error_of(
                  [](Outbox&) {
                    for (std::atomic<int> i = 0;; ++i) {
                    }
                  },
                  0.2),
              HasSubstr("did not end within 0.2 s"));
  EXPECT_THAT(error_of([](Outbox&) { pause(); }, 0.2), HasSubstr("did not end within 0.2 s"));
  EXPECT_GE(time_limit(0), 30.0);
  EXPECT_GE(time_limit(1'000'000'000) - time_limit(0), 1000.0);
  expect_no_child();
}

TEST(Guard, MemoryIsLimited) {
  if (sanitized) GTEST_SKIP() << "a sanitizer ends the process instead of throwing";
  const auto hoard = [](Outbox& out) {
    for (std::vector<std::vector<char>> all;; out.put(std::vector<char>(1)))
      all.emplace_back(1 << 28, 'x').shrink_to_fit();
  };
  EXPECT_THAT(
      error_of([&](Outbox& out) { std::vector<char>(std::size_t(1) << 40).swap(*new std::vector<char>), hoard(out); }),
      HasSubstr("more memory than there is"));
}

TEST(Guard, LinesAreLoggedOnce) {
  testing::internal::CaptureStderr();
  testing::internal::CaptureStdout();
  std::printf("this waits in the buffer");
  guarded("a.mesh", mend, [](Outbox& out) {
    out.warn("a warning");
    out.info("a remark");
    std::fflush(stdout);
  });
  const std::string text = testing::internal::GetCapturedStdout() + testing::internal::GetCapturedStderr();
  for (const char* line : {"a warning", "a remark", "this waits"}) {
    EXPECT_THAT(text, HasSubstr(line));
    EXPECT_EQ(text.find(line), text.rfind(line));
  }
}

TEST(Guard, SignalsDoNotDisturbTheWait) {
  struct sigaction old = {}, handler = {};
  handler.sa_handler = [](int) {};
  sigaction(SIGUSR1, &handler, &old);
  std::atomic<bool> done = false;
  const pthread_t self = pthread_self();
  std::thread nagging([&] {
    while (!done) pthread_kill(self, SIGUSR1), std::this_thread::sleep_for(std::chrono::milliseconds(1));
  });
  Inbox box = guarded("a.mesh", mend, [](Outbox& out) {
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    out.put(std::vector<int>{1});
  });
  done = true;
  nagging.join();
  sigaction(SIGUSR1, &old, nullptr);
  EXPECT_EQ(box.take<int>(), std::vector<int>{1});
}

TEST(Guard, ThreadsReadBesideEachOther) {
  std::atomic<bool> done = false;
  std::thread busy([&] {  // holds the logger and the heap most of the time
    while (!done) spdlog::debug("{}", std::string(1000, 'x'));
  });
  std::vector<std::thread> readers;
  std::atomic<int> right = 0;
  for (int t = 0; t < 4; ++t)
    readers.emplace_back([&, t] {
      for (int k = 0; k < 10; ++k) {
        Inbox box = guarded("a.mesh", mend, [&](Outbox& out) { out.put(std::vector<int>(1000 + t, k)); });
        right += box.take<int>() == std::vector<int>(1000 + t, k);
      }
    });
  for (std::thread& reader : readers) reader.join();
  done = true;
  busy.join();
  EXPECT_EQ(right, 40);
}

}  // namespace
}  // namespace penumbra
