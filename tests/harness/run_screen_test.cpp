// What a run prints at its end.
#include "harness/report/run_screen.h"

#include <fmt/format.h>

#include "tests/harness/screens.h"
#include "tests/support.h"

namespace penumbra {
namespace {

Row row(const std::string& scene, const std::string& technique, double ms, double error, double spread = 0.0) {
  Row r;
  r.id.scene = scene, r.id.technique = technique, r.id.backend = "simd", r.id.threads = 2, r.id.receivers = 16384;
  r.id.reads_spheres = false;
  r.timing.frame_ms = {ms - spread, ms - spread, ms, ms + spread, ms + spread};
  RungErrors truth;
  truth.report.all.receivers = 16384;
  truth.report.all.rel_rmse = error, truth.rel_noise = 0.002;
  r.score.errors["truth"] = truth;
  return r;
}

const RunSummary summary{"quick", "results/runs/latest", "2 cores of a CPU", 57.0};

std::string line_with(const std::string& text, const std::string& part) {
  const std::size_t at = text.find(part);
  if (at == std::string::npos) return "";
  const std::size_t begin = text.rfind('\n', at) + 1;
  return text.substr(begin, text.find('\n', at) - begin);
}

TEST(RunScreen, NamesTheBestWithinEachError) {
  const std::vector<Row> rows = {row("a", "slow-good", 50, 0.005), row("a", "fast-bad", 1, 0.09),
                                 row("a", "middling", 10, 0.02), row("a", "useless", 60, 0.5)};
  const std::string text = make_run_screen(summary, rows, 100);
  EXPECT_NE(line_with(text, "within 1 %").find("slow-good"), std::string::npos) << text;
  EXPECT_NE(line_with(text, "within 3 %").find("middling"), std::string::npos) << text;
  EXPECT_NE(line_with(text, "within 10 %").find("fast-bad"), std::string::npos) << text;
  EXPECT_NE(line_with(text, "within 1 %").find(" 50 "), std::string::npos) << text;
  EXPECT_EQ(text.find("useless"), std::string::npos) << "beaten by all others";
  EXPECT_NE(text.find("results/runs/latest/table.md"), std::string::npos);
  EXPECT_NE(text.find("16,384 receivers, truth ±0.2 %"), std::string::npos) << text;
}

TEST(RunScreen, OfEquallyFastRowsTheNearestIsTheBest) {
  const std::vector<Row> rows = {row("a", "a-bit-faster", 10.0, 0.025, 0.5), row("a", "nearer", 10.2, 0.011, 0.5)};
  EXPECT_NE(line_with(make_run_screen(summary, rows, 100), "within 3 %").find("nearer"), std::string::npos);
}

TEST(RunScreen, SaysWhatFailedAndWhy) {
  std::vector<Row> rows = {row("a", "good", 1, 0.001)};
  for (int k = 0; k < 7; ++k) {
    rows.push_back(row("a", "bad" + std::to_string(k), 1, 0.1));
    rows.back().status = k < 2 ? "failed: out of ideas" : "skipped: because of reason " + std::to_string(k);
  }
  const std::string text = make_run_screen(summary, rows, 100);
  EXPECT_NE(text.find("2 rows failed: out of ideas"), std::string::npos) << text;
  EXPECT_NE(text.find("more reasons"), std::string::npos) << text;
  EXPECT_NE(line_with(text, "within 1 %").find("good"), std::string::npos);
}

TEST(RunScreen, ABlackTruthAndRowsWithoutTimeAreNeverTheBest) {
  std::vector<Row> rows = {row("a", "timeless", 1, 0.001), row("a", "dark", 1, 0.001)};
  rows[0].timing.frame_ms.clear();
  rows[1].score.errors["truth"].report.all.rel_rmse.reset();
  const std::string text = make_run_screen(summary, rows, 100);
  EXPECT_NE(line_with(text, "within 10 %").find("none"), std::string::npos) << text;
  EXPECT_EQ(text.find("timeless"), std::string::npos) << text;
}

/// Whatever the number of scenes, names and failures: a screen.
TEST(RunScreen, FitsTheScreen) {
  for (const int scenes : {0, 1, 2, 4, 5, 6, 20, 21, 22, 60})
    for (const int techniques : {1, 40})
      for (const int width : {80, 100}) {
        std::vector<Row> rows;
        for (int s = 0; s < scenes; ++s)
          for (int t = 0; t < techniques; ++t) {
            rows.push_back(row(fmt::format("scene-{}{:x>{}}", s, "", s == 3 ? 190 : 0),
                               fmt::format("technique-{}{:y>{}}", t, "", t == 2 ? 90 : 0), 1.0 + 40 - t,
                               0.001 * (t + 1)));
            if (t == 5) rows.back().status = fmt::format("failed: {:z>300}", "");
          }
        const std::string text = make_run_screen(summary, rows, width);
        EXPECT_EQ(test::lines_too_long(text, width), "") << scenes;
        EXPECT_LE(test::count_lines(text), 25) << scenes << " " << techniques << "\n" << text;
      }
}

}  // namespace
}  // namespace penumbra
