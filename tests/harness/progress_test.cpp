#include "harness/measure/progress.h"

#include "harness/measure/reference.h"
#include "harness/results/text.h"
#include "scenes/scene_file.h"
#include "tests/harness/runs.h"

namespace penumbra {
namespace {

/// A screen that remembers what was written, and a clock that moves when told to. The timer thread may look at both.
class Screen {
 public:
  explicit Screen(bool terminal, int columns = 60) : terminal_(terminal), columns_(columns) {}
  ProgressOutput output() {
    return {terminal_, [this] { return columns_; },
            [this](const std::string& text) {
              const std::lock_guard guard(mutex_);
              writes_.push_back(text);
            },
            [this] { return seconds_.load(); }};
  }
  void wait(double seconds) { seconds_ = seconds_ + seconds; }
  std::vector<std::string> writes() {
    const std::lock_guard guard(mutex_);
    return writes_;
  }
  /// What stands in the line now, without what cleared it.
  std::string line() {
    const std::vector<std::string> all = writes();
    const std::string last = all.empty() ? "" : all.back();
    return last.starts_with("\r\033[K") ? last.substr(4) : last;
  }

 private:
  const bool terminal_;
  const int columns_;
  std::atomic<double> seconds_ = 100.0;
  std::mutex mutex_;
  std::vector<std::string> writes_;
};

TEST(Progress, SaysNothingOfWhatIsDoneWithinTwoSeconds) {
  for (const bool terminal : {false, true}) {
    Screen screen(terminal);
    {
      Progress progress(screen.output());
      const Progress::Still still(progress);
      for (int k = 0; k < 19; ++k) progress.step("a"), progress.share(0.5), screen.wait(0.1);
    }
    EXPECT_TRUE(screen.writes().empty()) << screen.writes().front();
  }
}

TEST(Progress, ElsewhereALineEveryTenSeconds) {
  Screen screen(false);
  Progress progress(screen.output());
  const Progress::Still still(progress);
  for (int k = 0; k < 200; ++k) progress.step("step " + std::to_string(k)), screen.wait(0.125);
  const auto writes = screen.writes();
  ASSERT_EQ(writes.size(), 3u) << "after 2, 12 and 22 of 25 seconds";
  EXPECT_EQ(writes[0], "step 16\n");
  EXPECT_EQ(writes[1], "step 96\n");
}

TEST(Progress, OnATerminalTheLineIsRewrittenAndClearedAway) {
  Screen screen(true);
  {
    Progress progress(screen.output());
    const Progress::Still still(progress);
    screen.wait(3.0);
    progress.step("a");
    progress.step("b");
    EXPECT_EQ(screen.writes().size(), 1u) << "not ten times a second";
    screen.wait(0.2);
    progress.step("c");
    progress.note("worth keeping");
  }
  const auto writes = screen.writes();
  EXPECT_EQ(writes, (std::vector<std::string>{"\r\033[Ka", "\r\033[Kc", "\r\033[K", "worth keeping\n"}));
}

TEST(Progress, NoLineIsAsWideAsTheTerminal) {
  for (const int columns : {1, 8, 20, 40, 80}) {
    Screen screen(true, columns);
    Progress progress(screen.output());
    const Progress::Still still(progress);
    progress.expect("check", 12, 3.0);
    for (int k = 0; k < 12; ++k) {
      screen.wait(1.1);
      progress.step("häschen-🐇-兔子-unter-himmel: checking pixel-basis/simd/visibility:raster", "check");
      screen.wait(1.1);
      progress.share("moving spheres", k / 12.0);
      EXPECT_LT(columns_of(screen.line()), columns) << screen.line();
    }
    if (columns == 80) {
      EXPECT_NE(screen.line().find("…, 92 %"), std::string::npos) << "the figures stay: " << screen.line();
    }
  }
}

TEST(Progress, TimeLeftIsThatOfStepsOfTheSameKind) {
  Screen screen(true, 200);
  Progress progress(screen.output());
  const Progress::Still still(progress);
  progress.expect("check", 4, 50.0);
  progress.expect("time", 100, 0.2);
  screen.wait(2.0);
  progress.step("a", "check");
  EXPECT_EQ(screen.line(), "[1 %, 3 min 40 s left] a") << "guesses: 4 x 50 + 100 x 0.2 s";
  screen.wait(3.0);
  progress.step("b", "check");
  EXPECT_EQ(screen.line(), "[15 %, 29 s left] b") << "3 s a check: 3 x 3 + 20 s, after 5 s";
  screen.wait(1.0);
  progress.share(0.25);
  EXPECT_EQ(screen.line(), "[17 %, 29 s left] b, 25 %") << "b takes 3 s more: 3 + 2 x 3 + 20 s, after 6 s";
  progress.expect("time", 0, 0.2);
  screen.wait(1.0);
  progress.share("a part of b", 0.5);
  EXPECT_EQ(screen.line(), "[50 %, 7 s left] b: a part of b, 50 %") << "of b itself 1 s is left: 1 + 2 x 3, after 7 s";
}

TEST(Progress, WithoutAnnouncedStepsThePieceOfWorkHasItsOwn) {
  Screen screen(true, 200);
  Progress progress(screen.output());
  const Progress::Still still(progress);
  screen.wait(2.0);
  progress.step("preparing");
  EXPECT_EQ(screen.line(), "preparing");
  screen.wait(5.0);
  progress.share("truth", 0.0);
  EXPECT_EQ(screen.line(), "preparing: truth, 0 %");
  screen.wait(4.0);
  progress.share("truth", 0.25);
  EXPECT_EQ(screen.line(), "preparing: truth, 25 %, 12 s left");
}

TEST(Progress, ATimerShowsForHowLongAStepHasBeenUnderWay) {
  Screen screen(true, 200);
  Progress progress(screen.output());
  progress.step("preparing");
  screen.wait(42.0);
  for (int tries = 0; tries < 100 && screen.line() != "preparing, 42 s"; ++tries)
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  EXPECT_EQ(screen.line(), "preparing, 42 s");
  progress.finish();
  EXPECT_EQ(screen.line(), "");
}

bool has_timer_thread() {
  for (const auto& task : std::filesystem::directory_iterator("/proc/self/task"))
    if (test::read_text(task.path().string() + "/comm") == "progress\n") return true;
  return false;
}

/// Notes whether the timer thread lives while it is prepared and while it is timed.
class Witness : public Technique {
 public:
  void prepare(const Scene&, const Light&) override { prepared_beside_timer = has_timer_thread(); }
  void update(const Frame&) override {}
  void shade(View<vec3> radiance) override {
    timer_beside_last_frame = has_timer_thread();
    for (std::size_t i = 0; i < radiance.size(); ++i) radiance[i] = vec3(1.0f);
  }
  Footprint footprint() const override { return {}; }
  static inline bool prepared_beside_timer = false, timer_beside_last_frame = true;
};

using test::Runs;

TEST_F(Runs, NoTimerWakesWhileFramesAreTimed) {
  Entry entry = test::fake("witness", Backend::scalar, "good");
  entry.make = [](const Parameters&) { return std::make_unique<Witness>(); };
  registry_.add(entry);
  EXPECT_EQ(run(suite_text({{"witness", "scalar"}})), 0);
  EXPECT_TRUE(Witness::prepared_beside_timer);
  EXPECT_FALSE(Witness::timer_beside_last_frame);
}

TEST(Progress, ReferencesTellHowFarTheyAre) {
  Scene scene = test::sphere_scene({{{0, 1, 0}, 0.5f}}, test::receivers_at(std::vector<vec3>(300, vec3(0.3f, 0, 0))));
  Animation animation(scene);
  ReferenceSettings settings;
  settings.truth_noise = 0.01;
  for (const Rung rung : {Rung::truth, Rung::cube, Rung::spheres}) {
    std::mutex mutex;
    std::vector<double> shares;
    const Reference with = compute_reference(animation.frame(0), rung, settings, [&](double share) {
      const std::lock_guard guard(mutex);
      shares.push_back(share);
    });
    std::sort(shares.begin(), shares.end());
    ASSERT_GE(shares.size(), 8u) << to_string(rung);
    EXPECT_LE(shares.front(), 0.5) << to_string(rung);
    if (rung == Rung::truth) EXPECT_GT(shares.back(), 0.7) << "predicted";
    else EXPECT_EQ(shares.back(), 1.0) << to_string(rung);
    const Reference without = compute_reference(animation.frame(0), rung, settings);
    EXPECT_EQ(with.rays_per_receiver, without.rays_per_receiver);
    for (std::size_t i = 0; i < with.mean.pixels.size(); ++i)
      ASSERT_TRUE(with.mean.pixels[i] == without.mean.pixels[i] &&
                  with.variance.pixels[i] == without.variance.pixels[i]);
  }
}

// Half way through its rounds the truth says about a half: noise falls with the root of their number.
TEST(Progress, TheTruthPredictsItsRounds) {
  Scene scene = test::sphere_scene({{{0, 1, 0}, 0.5f}}, test::receivers_at(std::vector<vec3>(300, vec3(0.3f, 0, 0))));
  Animation animation(scene);
  ReferenceSettings settings;
  settings.truth_noise = 0.002;
  std::vector<double> shares;
  compute_reference(animation.frame(0), Rung::truth, settings, [&](double share) { shares.push_back(share); });
  ASSERT_GE(shares.size(), std::size_t(8));
  EXPECT_NEAR(shares[shares.size() / 2], 0.5, 0.2);
}

}  // namespace
}  // namespace penumbra
