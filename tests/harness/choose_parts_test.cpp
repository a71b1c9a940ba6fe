// The parts of `penumbra choose` that need no scene: bounds, lamps, lines, brackets, the ladder of spheres.
#include <set>

#include "harness/catalogue/catalogue.h"
#include "harness/choose/bracket.h"
#include "harness/choose/new_scene.h"
#include "harness/choose/sphere_ladder.h"
#include "scenes/error.h"
#include "tests/support.h"

namespace penumbra {
namespace {

TEST(Bounds, ErrorsArePercentOrShares) {
  EXPECT_DOUBLE_EQ(parse_error_bound("2%").value, 0.02);
  EXPECT_DOUBLE_EQ(parse_error_bound("2.5 %").value, 0.025);
  EXPECT_DOUBLE_EQ(parse_error_bound("0.02").value, 0.02);
  EXPECT_DOUBLE_EQ(parse_error_bound("100%").value, 1.0);
  EXPECT_EQ(parse_error_bound("2%").kind, Bound::Kind::error);
  EXPECT_EQ(parse_error_bound("2%").text(), "2 %");
  for (const char* text :
       {"", "%", "0%", "-2%", "2", "0.05%", "101%", "nan", "inf%", "2 percent", "2%%", "two", "1e400%"})
    EXPECT_NE(test::error_of([&] { parse_error_bound(text); }).find("0.1% to 100%"), std::string::npos) << text;
}

TEST(Bounds, TimesHaveUnits) {
  EXPECT_DOUBLE_EQ(parse_time_bound("10ms").value, 10.0);
  EXPECT_DOUBLE_EQ(parse_time_bound("0.5 s").value, 500.0);
  EXPECT_DOUBLE_EQ(parse_time_bound("800us").value, 0.8);
  EXPECT_EQ(parse_time_bound("10ms").kind, Bound::Kind::time);
  for (const char* text : {"", "10", "ms", "0ms", "-1ms", "10 hours", "nanms", "infs", "1e9s", "10msx"})
    EXPECT_NE(test::error_of([&] { parse_time_bound(text); }).find("such as 10ms"), std::string::npos) << text;
}

TEST(Lamps, AreRectanglesOrDiscs) {
  const Lamp rectangle = parse_lamp("0.5x0.25@1,-2,3.5");
  EXPECT_EQ(rectangle.width, 0.5);
  EXPECT_EQ(rectangle.height, 0.25);
  EXPECT_EQ(rectangle.radius, 0.0);
  EXPECT_EQ(rectangle.x, 1.0);
  EXPECT_EQ(rectangle.y, -2.0);
  EXPECT_EQ(rectangle.z, 3.5);
  const Lamp disc = parse_lamp("0.5@1,2,3");
  EXPECT_EQ(disc.radius, 0.5);
  EXPECT_EQ(disc.width, 0.0);
  EXPECT_EQ(disc.z, 3.0);
  for (const char* text : {"", "1", "0x1@1,2,3", "1x0@1,2,3", "0@1,2,3", "-1@1,2,3", "1x1@1,2", "1x1@1,2,3,4",
                           "1x1@a,2,3", "nanx1@1,2,3", "1x1@1,inf,3", "1 x 1@1,2,3"})
    EXPECT_NE(test::error_of([&] { parse_lamp(text); }).find("WxH@x,y,z"), std::string::npos) << text;
}

/// Every technique that is registered can be searched: its lines hold values that it accepts, ascending, and each
/// combination stands once.
TEST(Lines, OfEveryEntryCanBeMade) {
  const Registry registry = make_registry();
  for (const Entry& entry : registry.entries()) {
    if (!entry.unavailable.empty()) continue;
    std::set<std::string> seen;
    const std::vector<Line> lines = lines_of(entry);
    EXPECT_FALSE(lines.empty()) << entry.title();
    for (const Line& line : lines) {
      EXPECT_EQ(line.knob.empty(), line.values.empty());
      EXPECT_TRUE(std::is_sorted(line.values.begin(), line.values.end())) << entry.title();
      std::vector<int> values = line.values;
      if (values.empty()) values = {0};
      for (const int value : values) {
        EXPECT_TRUE(seen.insert(line.at(value).describe()).second) << entry.title() << line.at(value).describe();
        EXPECT_NE(entry.make(line.at(value)), nullptr);
      }
    }
  }
}

TEST(Lines, MultiplyKnobsAndLeaveOutWhatIsRefused) {
  Entry entry;
  entry.name = "t", entry.backend = Backend::scalar;
  entry.parameters = {integer_parameter("n", 4, 1, 64, "", ""), choice_parameter("kind", {"a", "b"}, ""),
                      integer_parameter("size", 1, 1, 9, "", "")};
  entry.knobs = {{"n", {1, 8, 64}, true}, {"kind", {"a", "b"}}, {"size", {1, 2}}};
  entry.make = [](const Parameters& p) -> std::unique_ptr<Technique> {
    if (p.text("kind") == "b" && p.integer("size") == 2) throw Error("no");
    return nullptr;
  };
  const std::vector<Line> lines = lines_of(entry);
  ASSERT_EQ(lines.size(), 3u);
  for (const Line& line : lines) EXPECT_EQ(line.values, (std::vector<int>{1, 8, 64}));
  EXPECT_EQ(lines[1].at(8).describe(), "kind=a n=8 size=2");
}

TEST(Lines, KnobsAreCheckedWhenRegistered) {
  const auto fault = [](std::vector<Knob> knobs) {
    Entry entry;
    entry.name = "t", entry.backend = Backend::scalar;
    entry.parameters = {integer_parameter("n", 4, 1, 64, "", ""), choice_parameter("kind", {"a", "b"}, "")};
    entry.knobs = std::move(knobs);
    return test::error_of([&] { Registry().add(entry); });
  };
  EXPECT_EQ(fault({{"n", {1, 2}, true}}), "");
  EXPECT_NE(fault({{"m", {1}}}).find("no parameter 'm'"), std::string::npos);
  EXPECT_NE(fault({{"n", {65}}}).find("[1, 64]"), std::string::npos);
  EXPECT_NE(fault({{"n", {}}}).find("no values"), std::string::npos);
  EXPECT_NE(fault({{"kind", {"a"}, true}}).find("must hold integers"), std::string::npos);
  EXPECT_NE(fault({{"n", {1}, true}, {"n", {2}, true}}).find("allowed is one"), std::string::npos);
}

/// A line whose error is c / sqrt(n) and whose time is n x 0.1 ms.
class Brackets : public testing::Test {
 protected:
  Brackets() {
    line_.knob = "n";
    line_.values = {1, 2, 4, 8, 16, 32, 64, 128, 256, 512, 1024, 4096};
  }
  std::optional<Found> find(const Bound& bound, double c, const Worth& worth = {}) {
    looked_.clear();
    return best_on(
        line_, bound,
        [&](int n) -> std::optional<Look> {
          looked_.insert(n);
          if (n == broken_) return {};
          return Look{0.1 * n + fixed_, c / std::sqrt(double(n)), false};
        },
        worth);
  }
  Line line_;
  std::set<int> looked_;
  int broken_ = -1;
  double fixed_ = 0.0;
};

TEST_F(Brackets, FindTheLeastValueWithinAnError) {
  for (const double c : {0.021, 0.1, 0.15, 0.3, 0.77, 1.2}) {
    const auto found = find({Bound::Kind::error, 0.02}, c);
    const double exact = c * c / (0.02 * 0.02);
    ASSERT_TRUE(found);
    EXPECT_LE(*found->look.error, 0.02);
    EXPECT_GE(found->value, exact - 1e-6);
    EXPECT_LE(found->value, std::max(1.085 * exact, std::ceil(exact))) << c;
    EXPECT_LE(looked_.size(), 12u);
  }
}

TEST_F(Brackets, FindTheGreatestValueWithinATime) {
  for (const double ms : {0.1, 0.35, 3.0, 17.0, 300.0}) {
    const auto found = find({Bound::Kind::time, ms}, 1.0);
    ASSERT_TRUE(found);
    EXPECT_LE(found->look.ms, ms);
    EXPECT_GE(double(found->value), std::min(4096.0, std::floor(10.0 * ms)) / 1.085 - 1e-6) << ms;
  }
}

TEST_F(Brackets, WithoutAnythingWithinTheyNameTheNearest) {
  const auto coarse = find({Bound::Kind::error, 0.001}, 1.0);
  EXPECT_EQ(coarse->value, 4096);
  EXPECT_FALSE(coarse->look.within({Bound::Kind::error, 0.001}));
  EXPECT_EQ(find({Bound::Kind::time, 0.01}, 1.0)->value, 1);
  const auto all = find({Bound::Kind::error, 0.5}, 0.001);  // even the cheapest is good enough
  EXPECT_EQ(all->value, 1);
}

TEST_F(Brackets, GiveUpWhatIsTooSlow) {
  find({Bound::Kind::error, 0.001}, 1.0, {5.0, 5.0});
  EXPECT_LT(*looked_.rbegin(), 1024);
  fixed_ = 100.0;
  find({Bound::Kind::error, 0.02}, 0.001, {5.0, 5.0});
  EXPECT_EQ(looked_.size(), 2u);  // the middle and the cheapest end, which is as slow
}

TEST_F(Brackets, SurviveWhatCannotBeShaded) {
  broken_ = 32;  // the first that is looked at
  EXPECT_FALSE(find({Bound::Kind::error, 0.02}, 0.1));
  broken_ = 128;
  EXPECT_EQ(find({Bound::Kind::error, 0.02}, 0.2)->value, 32);
}

TEST_F(Brackets, ALineWithoutAKnobIsOneLook) {
  line_.knob.clear(), line_.values.clear();
  EXPECT_TRUE(find({Bound::Kind::time, 1.0}, 1.0));
  EXPECT_EQ(looked_, (std::set<int>{0}));
}

TEST(Looks, ATieIsWithinAnyError) {
  const Bound bound{Bound::Kind::error, 0.01};
  EXPECT_TRUE((Look{1.0, 0.012, true}.within(bound)));
  EXPECT_FALSE((Look{1.0, 0.012, false}.within(bound)));
  EXPECT_FALSE((Look{1.0, {}, false}.within(bound)));  // a black truth
}

/// Geometry 0.04 at 64 spheres; 0.08 at 16: it halves with four times as many.
TEST(SphereLadders, ForetellFromTwoCounts) {
  SphereLadder ladder;
  ladder.add({"a", 64, 8.0, 0.05, 0.04});
  EXPECT_NEAR(ladder.foretell({"a", 64, 8.0, 0.05, 0.04}, 256).geometry, 0.02, 1e-12);  // 1/2 until two are known
  ladder.add({"a", 16, 3.0, 0.085, 0.16});
  const SphereLook more = ladder.foretell({"a", 64, 8.0, 0.05, 0.04}, 128);
  EXPECT_NEAR(more.geometry, 0.02, 1e-12);  // 0.16 to 0.04 over a factor of 4
  EXPECT_NEAR(more.error, std::sqrt(0.05 * 0.05 - 0.04 * 0.04 + 0.02 * 0.02), 1e-12);
  EXPECT_NEAR(more.ms, 8.0 * std::pow(2.0, 0.8), 1e-12);
}

TEST(SphereLadders, BeginAt64And16AndFollowPromises) {
  const Bound bound{Bound::Kind::error, 0.04};
  SphereLadder ladder;
  EXPECT_EQ(ladder.next(bound, {}), 64);
  ladder.close(64);
  ladder.add({"a", 64, 8.0, 0.05, 0.05});
  EXPECT_EQ(ladder.next(bound, {}), 16);
  ladder.close(16);
  ladder.add({"a", 16, 3.0, 0.1, 0.1});
  EXPECT_EQ(ladder.next(bound, {}), 128);            // 0.035 and nothing better is known
  EXPECT_EQ(ladder.next(bound, 1.0), std::nullopt);  // what is known is faster than any more spheres could be
  ladder.close(128);
  EXPECT_EQ(ladder.next(bound, {}), 256);
}

TEST(SphereLadders, FewerAreTriedForATechniquesOwnSake) {
  const Bound bound{Bound::Kind::error, 0.2};
  SphereLadder ladder;
  ladder.close(64), ladder.close(16);
  ladder.add({"a", 64, 8.0, 0.05, 0.05});
  ladder.add({"a", 16, 3.0, 0.1, 0.1});
  EXPECT_EQ(ladder.next(bound, 0.1), 8);  // within, and faster than its own 3 ms, if not than the best
  ladder.close(8);
  EXPECT_EQ(ladder.next(bound, 0.1), std::nullopt);
}

}  // namespace
}  // namespace penumbra
