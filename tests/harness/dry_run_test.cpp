// What a run would do and about how long it takes, said without doing it.
#include "harness/commands/dry_run.h"

#include <gmock/gmock.h>
#include <cmath>

#include <regex>

#include "harness/measure/expected_time.h"
#include "tests/harness/runs.h"

namespace penumbra {
namespace {

using testing::HasSubstr;
using testing::Not;

class DryRuns : public test::Runs {
 protected:
  std::string dry(const std::string& text, bool resume = false, const std::vector<std::string>& scenes = {}) {
    const Suite suite = load_suite(folder_.write("suite.toml", text), registry_, 1, scenes);
    testing::internal::CaptureStdout();
    const std::string error = test::error_of([&] { dry_run(suite, {out(), ".*", 2, resume}); });
    const std::string printed = testing::internal::GetCapturedStdout();
    if (!error.empty()) throw Error("{}", error);
    return std::regex_replace(printed, std::regex("\\s+"), " ");  // wherever lines are broken
  }
};

TEST_F(DryRuns, SaysWhatIsThereAndWritesNothing) {
  const std::string scene =
      folder_.write("lit.toml", test::scene_named("lit", test::constant, "spheres = 4\nobjective = \"grid\"\n"));
  const std::string suite = test::suite_of({scene});
  const std::string before = dry(suite);
  EXPECT_THAT(before, HasSubstr("suite t: 1 row on 1 scene, 2 repetitions"));
  EXPECT_THAT(before, HasSubstr("lit: 256 receivers, 4 spheres for grid"));
  EXPECT_THAT(before, HasSubstr("fit to do"));
  EXPECT_THAT(before, HasSubstr("references to compute: truth, cube 32, spheres 32"));
  EXPECT_THAT(before, HasSubstr("rows 1: good scalar threads:1"));
  EXPECT_THAT(before, HasSubstr("0 of 1 row as measured"));
  EXPECT_FALSE(std::filesystem::exists(out()));
  EXPECT_FALSE(std::filesystem::exists(folder_.path() + "/cache"));

  run(suite);
  const std::string after = dry(suite);
  EXPECT_THAT(after, HasSubstr("fit in the cache"));
  EXPECT_THAT(after, HasSubstr("references in the cache: truth, cube 32, spheres 32 rows"));
  EXPECT_THAT(after, HasSubstr("1 of 1 row as measured"));
  EXPECT_THAT(after, HasSubstr("fits 0 s, references 0 s"));
  EXPECT_THAT(after, Not(HasSubstr("already")));
  EXPECT_THAT(dry(suite, true), HasSubstr("1 row in " + out() + " already"));
}

TEST_F(DryRuns, NamesRowsThatAreSkippedAndTheReason) {
  registry_.add(test::fake("sky-only", Backend::scalar, "no-area"));
  const std::string lamp = folder_.write(
      "lamp.toml", test::scene_named("lamp", "area = { centre = [0, 9, 0], normal = [0, -1, 0], radius = 1.0 }"));
  const std::string text =
      dry(test::suite_of({lamp}, "sky-only", "[[technique]]\nname = \"good\"\nbackend = \"scalar\"\n"));
  EXPECT_THAT(text, HasSubstr("1 row on 1 scene, 2 repetitions; 1 more skipped"));
  EXPECT_THAT(text, HasSubstr("skipped cannot shade an area light: sky-only scalar threads:1"));
  EXPECT_THAT(text, HasSubstr("13x13"));
  EXPECT_THAT(text, Not(HasSubstr("cube")));
}

TEST_F(DryRuns, AnySuiteOnAnyScene) {
  const std::string other = folder_.write("other.toml", test::scene_named("other", test::constant));
  const std::string suite = test::suite_of({scene_});
  EXPECT_THAT(dry(suite, false, {other, scene_}), HasSubstr("2 rows on 2 scenes"));
  EXPECT_THAT(dry(suite, false, {other}), Not(HasSubstr("tiny")));
  EXPECT_THAT(dry("name = \"t\"\n[[technique]]\nname = \"good\"\nbackend = \"scalar\"\n", false, {other}),
              HasSubstr("other: 256 receivers, no spheres"))
      << "a suite that names no scenes";
  const auto error = [&](const std::string& scene) { return test::error_of([&] { dry(suite, false, {scene}); }); };
  EXPECT_THAT(error("no-such"), HasSubstr("--scene: 'no-such' is neither a file nor shipped"));
  EXPECT_THAT(error(folder_.path() + "/none.toml"), HasSubstr("none.toml is no file"));
  const Suite suite_on_other = load_suite(folder_.write("s.toml", suite), registry_, 1, {other});
  testing::internal::CaptureStdout();
  EXPECT_EQ(run_suite(suite_on_other, registry_, {out(), ".*", 2, false}), 0);
  testing::internal::GetCapturedStdout();
  EXPECT_EQ(row("good").id.scene, "other");
}

TEST_F(DryRuns, FramesOfAMotionAreCounted) {
  const std::string moving = folder_.write("moving.toml", test::scene_named("moving", test::constant) +
                                                              "[motion]\nkind = \"twist\"\nframes = 3\nperiod = 3\n");
  const std::string suite = test::suite_of({moving}, "good", "sequence = true\n");
  EXPECT_THAT(dry(suite), HasSubstr("to compute: truth, cube 32, truth of 3 frames"));
  run(suite);
  EXPECT_THAT(dry(suite), HasSubstr("in the cache: truth, cube 32, truth of 3 frames"));
}

RowIdentity identity(const std::string& scene, std::size_t receivers) {
  RowIdentity id;
  id.scene = scene, id.technique = "a", id.backend = "scalar", id.receivers = receivers;
  return id;
}

TEST(ExpectedTime, OfRowsIsWhatTheyTookScaledToTheReceivers) {
  Row row;
  row.id = identity("here", 1000);
  row.timing.prepare_ms = 500.0, row.timing.frame_ms = {200.0, 200.0, 200.0};
  const ExpectedRow same = expected_row(row.id, 9, 0, {row});
  EXPECT_TRUE(same.measured);
  EXPECT_NEAR(same.seconds, 0.5 + 2 * 0.2 + 0.1 + 0.005 + 9 * 0.2, 1e-9);
  EXPECT_NEAR(expected_row(row.id, 9, 4, {row}).seconds - same.seconds, 4 * 0.2, 1e-9);
  const ExpectedRow larger = expected_row(identity("there", 4000), 9, 0, {row});
  EXPECT_TRUE(larger.measured);
  EXPECT_NEAR(larger.seconds, 4 * (0.5 + 2 * 0.2 + 9 * 0.2) + 0.1 + 0.02, 1e-9);
  row.timing.frame_ms = {1.0};
  EXPECT_NEAR(expected_row(row.id, 9, 0, {row}).seconds, 0.5 + 2 * 0.001 + 0.105 + 9 * 0.03, 1e-9)
      << "repetitions last at least 30 ms";
  row.status = "failed: why";
  EXPECT_FALSE(expected_row(row.id, 9, 0, {row}).measured);
  EXPECT_GT(expected_row(identity("x", 1000000), 9, 0, {}).seconds,
            5 * expected_row(identity("x", 100000), 9, 0, {}).seconds);
}

TEST(ExpectedTime, OfReferencesGrowsWithReceiversAndFallsWithTheNoise) {
  const double once = expected_reference(Rung::truth, true, 1000, 0.002);
  EXPECT_NEAR(expected_reference(Rung::truth, true, 3000, 0.002), 3 * once, 1e-9);
  EXPECT_NEAR(expected_reference(Rung::truth, true, 1000, 0.004), once / std::pow(2.0, 4.0 / 3.0), 1e-9)
      << "rounds are stratified";
  const double lamp = expected_reference(Rung::truth, false, 1000, 0.002);
  EXPECT_NEAR(expected_reference(Rung::truth, false, 1000, 0.004), lamp / 4, 1e-9);
  EXPECT_GT(expected_fit(64, "shadow"), expected_fit(64, "cover"));
  EXPECT_GT(expected_fit(64, "cover"), expected_fit(8, "cover"));
}

TEST(ExpectedTime, SaysNoMoreDigitsThanAreKnown) {
  EXPECT_EQ(about(0.4), "less than a second");
  EXPECT_EQ(about(4.6), "about 5 s");
  EXPECT_EQ(about(44.0), "about 40 s");
  EXPECT_EQ(about(200.0), "about 3 min");
  EXPECT_EQ(about(8000.0), "about 2 h");
}

}  // namespace
}  // namespace penumbra
