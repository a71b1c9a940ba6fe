#include "harness/report/published.h"

#include "harness/report/published_times.h"

#include "tests/support.h"

namespace penumbra {
namespace {

Row wavelet_row(int spheres, int terms, double ms, int level = 2) {
  Row row;
  row.id.scene = "s", row.id.technique = "wavelet", row.id.backend = "simd";
  row.id.spheres = std::size_t(spheres);
  row.id.parameters["terms"] = terms;
  row.id.parameters["level"] = level;
  row.timing.frame_ms = {ms};
  return row;
}

TEST(Published, Table2OfZhaoAndChe) {
  const PublishedTable table = PublishedTable::load("zhao-che-2011-table2");
  EXPECT_EQ(table.devices(), (std::vector<std::string>{"cpu", "gpu-1", "gpu-2"}));
  const auto fps = table.lookup(wavelet_row(128, 200, 10));
  EXPECT_EQ(fps, (std::map<std::string, double>{{"cpu", 0.83}, {"gpu-2", 12.80}})) << "GPU-II has both levels";
  EXPECT_EQ(table.lookup(wavelet_row(128, 200, 10, 1)),
            (std::map<std::string, double>{{"cpu", 0.83}, {"gpu-1", 14.10}}));
  EXPECT_TRUE(table.lookup(wavelet_row(128, 201, 10)).empty());
  EXPECT_TRUE(table.lookup(Row()).empty()) << "rows without terms are not in the table";
}

TEST(Published, PrintsRatios) {
  const std::string text =
      make_published_table(PublishedTable::load("zhao-che-2011-table2"), {wavelet_row(32, 50, 1000.0 / 63.06)});
  EXPECT_NE(text.find("| 50 | 32 | 2 | **63.1** | 2.91 | 21.7 | 31.53 | 2 |"), std::string::npos) << text;
  const std::string slow =
      make_published_table(PublishedTable::load("zhao-che-2011-table2"), {wavelet_row(32, 50, 1000.0 / 3.9, 1)});
  EXPECT_NE(slow.find("34.45 | 0.113 |"), std::string::npos) << "a small ratio keeps its digits: " << slow;
}

TEST(Published, TimesAreComparedAsRatiosWithinTableAndSubject) {
  PublishedTimes asked{"s",
                       "zhu-2019-tables",
                       {{"3", "scene a", "PCSS", "/slow/", {}}, {"3", "scene a", "Fast PCSS", "/fast/", {"x", "y"}}}};
  check_published_times(asked);
  const auto row = [](const char* technique, double ms) {
    Row r;
    r.id.scene = "s", r.id.technique = technique, r.id.backend = "simd", r.timing.frame_ms = {ms};
    r.timing.stages = {{"x", {1}}, {"y", {3}}, {"z", {100}}};
    return r;
  };
  const std::string text = make_published_times_table(asked, {row("slow", 50), row("fast", 200)});
  EXPECT_NE(text.find("PCSS | 188.7 | 1 | slow, s simd, 1 threads | frame | 50 | **1** |"), std::string::npos);
  EXPECT_NE(text.find("Fast PCSS | 8.8 | 0.0466 | fast, s simd, 1 threads | x + y | 4 | **0.08** |"), std::string::npos)
      << text;
  asked.times[0].variant = "Slow PCSS";
  EXPECT_NE(test::error_of([&] { check_published_times(asked); }).find("Slow PCSS"), std::string::npos);
  asked.times[0] = {"3", "scene a", "PCSS", "(", {}};
  EXPECT_NE(test::error_of([&] { check_published_times(asked); }).find("regular expression"), std::string::npos);
}

TEST(Published, MissingTablesAreErrors) {
  EXPECT_NE(test::error_of([] { PublishedTable::load("nobody-1999"); }).find("nobody-1999"), std::string::npos);
}

}  // namespace
}  // namespace penumbra
