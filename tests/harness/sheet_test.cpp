#include "harness/report/sheet.h"

#include "harness/results/pictures.h"
#include "tests/harness/runs.h"

namespace penumbra {
namespace {

using test::grey;

/// Is every pixel of a rectangle white?
bool white(const Image& image, int x, int y, int width, int height) {
  for (int v = y; v < std::min(image.height, y + height); ++v)
    for (int u = x; u < std::min(image.width, x + width); ++u)
      if (image.pixels[std::size_t(v) * image.width + u] != vec3(1.0f)) return false;
  return true;
}

/// A folder of results with grey images of one size, and rows that name them.
class Sheets : public testing::Test {
 protected:
  Row row(const std::string& technique, int width, int height, float value = 0.4f) {
    Row r;
    r.id.scene = "s", r.id.technique = technique, r.id.backend = "simd", r.id.receivers = 16384;
    r.timing.frame_ms = {1.0, 1.1, 0.9};
    r.score.errors["truth"].report.all.receivers = 4;
    r.score.errors["truth"].report.all.rel_rmse = 0.0303;
    r.score.errors["truth"].rel_noise = 0.0019;
    r.facts.image = "images/s/" + technique;
    const Image image = grey(std::vector<float>(std::size_t(width * height), value), width);
    save_png(folder_.path() + "/" + r.facts.image + ".png", image);
    save_png(folder_.path() + "/" + r.facts.image + ".error.png",
             grey(std::vector<float>(image.pixels.size(), 0.7f), width));
    save_png(folder_.path() + "/images/s/truth.png", grey(std::vector<float>(image.pixels.size(), 0.2f), width));
    return r;
  }
  const test::TemporaryFolder folder_;
  const Lettering none_ = Lettering({"no-such-font"});
};

TEST_F(Sheets, HoldTheTruthOnceAndErrorsBelow) {
  const Row a = row("a", 128, 64, 0.4f), b = row("b", 128, 64, 0.5f), c = row("c", 128, 64, 0.6f),
            d = row("d", 128, 64, 0.7f);
  const Image sheet = draw_sheet(folder_.path(), {{&a, &b, &c, &d}}, 4, none_);
  ASSERT_EQ(sheet.width, 3 * 256 + 4 * 10)
      << "five panels in two lines: three and two; of twice their size, gaps of 10";
  const auto at = [&](int x, int y) { return sheet.pixels[std::size_t(y) * sheet.width + x].x; };
  EXPECT_NEAR(at(20, 20), 0.2f, 0.01f) << "the truth";
  EXPECT_NEAR(at(286, 20), 0.4f, 0.01f);
  EXPECT_NEAR(at(552, 20), 0.5f, 0.01f);
  EXPECT_NEAR(at(286, 160), 0.7f, 0.01f) << "its error";
  const int second = 10 + 128 + 10 + 128 + 20;  // the next line of panels: of the third row, no truth before it
  EXPECT_NEAR(at(20, second + 10), 0.6f, 0.01f);
  EXPECT_TRUE(white(sheet, 542, second, 500, 200));
  EXPECT_EQ(sheet.height, 2 * second - 10);
}

TEST_F(Sheets, TheBarBelowTheTruthHasTheColoursOfErrors) {
  const Row a = row("a", 128, 128);
  const Image sheet = draw_sheet(folder_.path(), {{&a}}, 6, none_);
  const vec3* bar = &sheet.pixels[std::size_t(10 + 256 + 10 + 5) * sheet.width + 10];
  const auto expect_colour = [&](int x, vec3 colour) {
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(bar[x][c], colour[c], 0.01f) << x;
  };
  expect_colour(0, {0, 0, 1});
  expect_colour(127, vec3(1.0f));
  expect_colour(255, {1, 0, 0});
}

TEST_F(Sheets, LabelsStayWithinTheirColumn) {
  const Lettering lettering;
  if (!lettering.available()) GTEST_SKIP() << "no font";
  Row a = row("a-technique-with-a-name-that-is-longer-than-its-panel-is-wide", 128, 128);
  a.id.parameters["visibility"] = std::string("raster");
  a.id.parameters["resolution"] = 32;
  a.id.parameters["something-that-makes-the-label-very-long"] = 32;
  a.id.parameters["something-else-that-makes-the-label-very-long"] = 32;
  Row b = row("b", 128, 128);
  const Image sheet = draw_sheet(folder_.path(), {{&a, &b}}, 6),
              plain = draw_sheet(folder_.path(), {{&a, &b}}, 6, none_);
  ASSERT_EQ(sheet.width, plain.width);
  EXPECT_GT(sheet.height, plain.height);
  const int captions = sheet.height - (plain.height - 10);  // everything above the images
  EXPECT_FALSE(white(sheet, 10, 28, 256, captions - 28)) << "truth";
  EXPECT_FALSE(white(sheet, 276, 28, 256, captions - 28)) << "a";
  EXPECT_FALSE(white(sheet, 542, 28, 256, captions - 28)) << "b";
  for (const int x : {0, 267, 533, 799})
    EXPECT_TRUE(white(sheet, x, 28, 8, captions - 28)) << "between columns, at " << x;
  const int bar = captions + 256 + 10 + 14;
  EXPECT_FALSE(white(sheet, 10, bar, 256, 17)) << "the scale";
}

TEST_F(Sheets, SeveralScenesStandOneAboveTheOther) {
  const Row a = row("a", 128, 128), b = row("b", 128, 128);
  const Image one = draw_sheet(folder_.path(), {{&a}}, 6), two = draw_sheet(folder_.path(), {{&a}, {&b}}, 6);
  EXPECT_EQ(two.width, one.width);
  EXPECT_EQ(two.height, 2 * one.height);
}

TEST_F(Sheets, WhatCannotBeReadIsLeftOut) {
  const Row a = row("a", 64, 64), line = row("line", 64, 1);
  Row gone = row("gone", 64, 64), nameless = row("nameless", 64, 64);
  row("a", 64, 64);  // a truth of the right size
  std::filesystem::remove(folder_.path() + "/images/s/gone.png");
  nameless.facts.image.clear();
  const Image all = draw_sheet(folder_.path(), {{&gone, &a, &line, &nameless}}, 6, none_),
              alone = draw_sheet(folder_.path(), {{&a}}, 6, none_);
  EXPECT_EQ(all.width, alone.width);
  EXPECT_TRUE(draw_sheet(folder_.path(), {{&gone}}, 6, none_).pixels.empty());
  EXPECT_TRUE(draw_sheet(folder_.path(), {}, 6, none_).pixels.empty());
}

TEST(Lettering, FitsAndWraps) {
  const Lettering letters;
  if (!letters.available()) GTEST_SKIP() << "no font";
  const int width = letters.width("sh-exponentiation", 13);
  EXPECT_GT(width, 50);
  EXPECT_EQ(letters.fitted("sh-exponentiation", width, 13), "sh-exponentiation");
  const std::string cut = letters.fitted("sh-exponentiation", width - 1, 13);
  EXPECT_TRUE(cut.ends_with("…")) << cut;
  EXPECT_LE(letters.width(cut, 13), width - 1);
  EXPECT_EQ(letters.fitted("abc", 1, 13), "");
  const auto lines = letters.wrapped("one two three four five six seven", width, 13, 2);
  ASSERT_EQ(lines.size(), 2u);
  for (const std::string& line : lines) EXPECT_LE(letters.width(line, 13), width) << line;
  EXPECT_TRUE(lines[1].ends_with("…"));
  EXPECT_TRUE(letters.wrapped("", width, 13, 2).empty());
}

TEST(Lettering, DrawsAsciiAndWhatCanBeSaidInIt) {
  EXPECT_EQ(drawable("truth ±0.2 %…"), "truth +-0.2 %...");
  EXPECT_EQ(drawable("häs-兔\xff"), "h?s-??");
}

TEST(Lettering, WithoutAFontNothingIsDrawn) {
  const Lettering none({"no-such-font"});
  EXPECT_FALSE(none.available());
  EXPECT_EQ(none.width("text", 13), 0);
  EXPECT_EQ(none.fitted("text", 1, 13), "text");
  Image image = grey(std::vector<float>(100, 1.0f), 10);
  none.draw("text", 0, 9, 13, image);
  EXPECT_TRUE(white(image, 0, 0, 10, 10));
}

using test::Runs;

TEST_F(Runs, AResumedRunDrawsTheRowsThatItKept) {
  const std::string suite = suite_text({{"good", "scalar"}}), overview = out() + "/images/tiny-0-spheres/overview.png";
  run(suite);
  const Image before = load_picture(overview);
  EXPECT_EQ(run(suite_text({{"good", "scalar"}, {"spy", "scalar"}}), true), 0);
  const Image after = load_picture(overview);
  EXPECT_GT(after.width, before.width) << "both rows are on it, though one was kept";
  std::filesystem::remove(overview);
  EXPECT_EQ(run(suite_text({{"good", "scalar"}, {"spy", "scalar"}}), true), 0);
  EXPECT_EQ(load_picture(overview).width, after.width) << "drawn again though nothing was measured";
}

}  // namespace
}  // namespace penumbra
