// What becomes of a clock's laps.
#include "harness/measure/timing.h"

#include "tests/support.h"

namespace penumbra {
namespace {

/// 2 ms for every update, 3 ms for every shade.
class FixedClock final : public Clock {
 public:
  void start() override { laps_ = 0; }
  double lap() override { return laps_++ == 0 ? 2.0 : 3.0; }

 private:
  int laps_ = 0;
};

class Ticking final : public Technique {
 public:
  void prepare(const Scene&, const Light&) override {}
  void update(const Frame&) override { ++frames; }
  void shade(View<vec3>) override {
    if (frames == fail_at) throw std::runtime_error("stuck");
  }
  Footprint footprint() const override { return {}; }
  std::vector<Stage> stages() const override { return {{"a", 1.0}, {"b", 0.5}}; }
  std::unique_ptr<Clock> make_clock() const override { return std::make_unique<FixedClock>(); }

  int frames = 0, fail_at = -1;
};

class Timings : public testing::Test {
 protected:
  /// Frames of 5 ms: six of them make a repetition.
  void time(int repetitions) {
    std::vector<TimedItem> items;
    const Scene scene = test::sphere_scene({}, test::receivers_at({vec3(0.0f)}));
    for (Ticking* t : {&good_, &bad_}) items.push_back({t == &good_ ? "good" : "bad", t, &scene, 1, 5.0, {}, ""});
    time_items(items, repetitions, {[&] { ++begun_; }, [&](const TimedItem& item) { finished_.push_back(item); }});
  }
  Ticking good_, bad_;
  std::vector<TimedItem> finished_;
  int begun_ = 0;
};

TEST_F(Timings, SamplesAreMeansPerFrame) {
  bad_.fail_at = 8;
  time(4);
  ASSERT_EQ(finished_.size(), 2u);
  const TimedItem& good = finished_[finished_[0].name == "good" ? 0 : 1];
  const TimedItem& bad = finished_[finished_[0].name == "good" ? 1 : 0];
  EXPECT_EQ(good.timing.iterations, 6);
  EXPECT_EQ(good_.frames, 24);
  EXPECT_EQ(good.timing.update_ms, std::vector<double>(4, 2.0));
  EXPECT_EQ(good.timing.shade_ms, std::vector<double>(4, 3.0));
  EXPECT_EQ(good.timing.frame_ms, std::vector<double>(4, 5.0));
  ASSERT_EQ(good.timing.stages.size(), 2u);
  EXPECT_EQ(good.timing.stages[1].name, "b");
  EXPECT_EQ(good.timing.stages[1].ms, std::vector<double>(4, 0.5));
  EXPECT_EQ(good.failure, "");
  EXPECT_EQ(bad.failure, "stuck");
  EXPECT_EQ(bad.timing.frame_ms.size(), 1u) << "the repetition in which it failed is no sample";
}

}  // namespace
}  // namespace penumbra
