// What a comparison prints.
#include "harness/report/comparison_text.h"

#include <fmt/format.h>

#include "tests/harness/screens.h"
#include "tests/support.h"

namespace penumbra {
namespace {

Row row(const std::string& technique, double ms, double error) {
  Row r;
  r.id.scene = "a-scene-with-a-name", r.id.technique = technique, r.id.backend = "simd", r.id.receivers = 1000;
  for (int k = 0; k < 9; ++k) r.timing.frame_ms.push_back(ms * (1.0 + 0.001 * k));
  RungErrors truth;
  truth.report.all.receivers = 1000;
  truth.report.all.rmse = error, truth.report.all.rel_rmse = error, truth.noise = 1e-4;
  r.score.errors["truth"] = truth;
  return r;
}

/// A hundred rows, of which thirty became slower and worse.
struct Runs {
  Runs() {
    for (int k = 0; k < 100; ++k) {
      base.rows.push_back(
          row(fmt::format("technique-{}-with-a-very-long-name-that-goes-on-and-on-and-on", k), 1.0, 0.02));
      next.rows.push_back(base.rows.back());
      if (k < 40 && k >= 10) next.rows.back() = row(base.rows.back().id.technique, 1.2 + 0.03 * k, 0.03 + 0.001 * k);
    }
    base.rows.push_back(row("gone", 1.0, 0.02));
    next.rows.push_back(row("come|with a pipe", 1.0, 0.02));
  }
  Results base, next;
};

TEST(ComparisonScreen, FitsTheScreenAndNamesTheWorst) {
  const Runs runs;
  const Comparison comparison = compare(runs.base, runs.next, {});
  for (const int width : {40, 60, 80, 100}) {
    const std::string text = make_comparison_screen(comparison, width);
    EXPECT_EQ(test::lines_too_long(text, width), "") << text;
    EXPECT_LE(test::count_lines(text), 20) << text;
  }
  const std::string text = make_comparison_screen(comparison, 100);
  EXPECT_TRUE(text.starts_with("REGRESSION: 30 regressions, 30 slower, 30 with more error, 70 same")) << text;
  EXPECT_NE(text.find("technique-39"), std::string::npos) << "the worst: " << text;
  EXPECT_NE(text.find("SLOWER"), std::string::npos) << text;
  EXPECT_NE(text.find("removed: "), std::string::npos) << text;
  EXPECT_NE(text.find("more (--json lists all)"), std::string::npos) << text;
}

/// What tells rows apart stands at the end of their names.
TEST(ComparisonScreen, TellsRowsApartAndHowMuch) {
  Results base, next;
  for (const char* way : {"table", "raster"}) {
    Row r = row("pixel-basis-of-some-kind", 1.0, 0.0293);
    r.id.parameters = {{"visibility", std::string(way)}};
    base.rows.push_back(r);
    Row worse = row("pixel-basis-of-some-kind", 1.0, 0.0311);
    worse.id = r.id;
    next.rows.push_back(worse);
  }
  const std::string text = make_comparison_screen(compare(base, next, {}), 80);
  for (const char* part : {"table", "raster", "2.93 -> 3.11 %"}) EXPECT_NE(text.find(part), std::string::npos) << text;
}

TEST(ComparisonScreen, NamesReasonsOnceAndWhole) {
  Results base, next;
  for (int k = 0; k < 3; ++k) {
    base.rows.push_back(row(fmt::format("t{}", k), 1.0, 0.02)), next.rows.push_back(base.rows.back());
    next.rows.back().timing.frame_ms = {0.5, 1.0, 2.0};
  }
  next.rows[2].facts.instruction_set = "AVX9";
  const std::string text = make_comparison_screen(compare(base, next, {}), 80);
  EXPECT_NE(text.find("(--repetitions)"), std::string::npos) << text;
  EXPECT_NE(text.find("(2 rows)"), std::string::npos) << text;
  EXPECT_NE(text.find("the instruction set differs (a-scene-with-a-name: t2)"), std::string::npos) << text;
}

TEST(ComparisonScreen, ListsWhatIsGoneAsFarAsThereIsRoom) {
  Results base, next;
  for (int k = 0; k < 300; ++k) base.rows.push_back(row(fmt::format("t{}", k), 1.0, 0.02));
  next.rows = {base.rows[0], row("come", 1.0, 0.02)};
  const std::string text = make_comparison_screen(compare(base, next, {}), 80);
  EXPECT_LE(test::count_lines(text), 20) << text;
  EXPECT_GE(test::count_lines(text), 10) << text;
  EXPECT_NE(text.find("more (--json lists all)"), std::string::npos) << text;
  EXPECT_NE(text.find("added: a-scene-with-a-name"), std::string::npos) << text;
}

TEST(ComparisonText, NamesSteerNeitherTerminalNorPage) {
  const std::string hostile = "x\x1b[31m\n| `code` <img src=x> @user \xE2\x80\xAE";
  Results base, next;
  base.rows = {row(hostile, 1.0, 0.02)}, next.rows = {row(hostile, 2.0, 0.02)};
  next.context["cpu_name"] = "<img src=x>|\n# H1 @all";
  const Comparison comparison = compare(base, next, {});
  const std::string screen = make_comparison_screen(comparison, 80), page = make_comparison_markdown(comparison);
  for (const std::string& text : {screen, page})
    for (const char* steer : {"\x1b", "\xE2\x80\xAE"}) EXPECT_EQ(text.find(steer), std::string::npos) << text;
  EXPECT_EQ(page.find("\n# H1"), std::string::npos) << page;
  EXPECT_EQ(page.find("`code`"), std::string::npos) << page;
  const std::string prose = page.substr(0, page.find('`')) + page.substr(page.rfind('`'));
  EXPECT_EQ(prose.find("<img"), std::string::npos) << page;
  EXPECT_EQ(prose.find("@all"), std::string::npos) << page;
}

TEST(ComparisonMarkdown, HasEveryRowOnce) {
  const Runs runs;
  const std::string text = make_comparison_markdown(compare(runs.base, runs.next, {}));
  for (const Row& r : runs.next.rows) {
    if (r.id.technique.starts_with("come")) continue;
    const std::size_t first = text.find("`" + r.id.name() + "`");
    ASSERT_NE(first, std::string::npos) << r.id.name();
    EXPECT_EQ(text.find("`" + r.id.name() + "`", first + 1), std::string::npos) << r.id.name();
  }
  EXPECT_LT(text.find("technique-39"), text.find("<details>"));
  EXPECT_GT(text.find("technique-3-"), text.find("<details>"));
  EXPECT_NE(text.find("2 -> 6.9 %"), std::string::npos) << text.substr(0, 2000);
}

TEST(ComparisonJson, HoldsFiguresAndNoNumberThatIsNone) {
  const Runs runs;
  const nlohmann::json out = comparison_json(compare(runs.base, runs.next, {}));
  EXPECT_EQ(out["exit_code"], 1);
  EXPECT_EQ(out["rows"].size(), 100u);
  EXPECT_EQ(out["rows"][0]["time"]["verdict"], "slower");
  EXPECT_NEAR(out["rows"][0]["time"]["ratio"].get<double>(), 2.37, 1e-9);
  EXPECT_EQ(out["rows"][0]["error"]["rung"], "truth");
  EXPECT_EQ(out["removed"].size(), 1u);
  EXPECT_EQ(nlohmann::json::parse(out.dump()), out);
}

TEST(ComparisonPictures, AreOfRowsWhoseErrorChanged) {
  Runs runs;
  const test::TemporaryFolder folder;
  for (const char* side : {"/base", "/new"}) {
    std::filesystem::create_directories(folder.path() + side + "/images");
    for (Row& r : side[1] == 'b' ? runs.base.rows : runs.next.rows) r.facts.image = "images/one";
    const float value = side[1] == 'b' ? 0.5f : 0.6f;
    save_exr(folder.path() + side + "/images/one.exr", {16, 16, std::vector<vec3>(256, vec3(value))});
  }
  const auto files = save_comparison_pictures(compare(runs.base, runs.next, {}), folder.path() + "/base",
                                              folder.path() + "/new", folder.path() + "/changed");
  EXPECT_EQ(files.size(), 20u) << "at most";
  for (const std::string& file : files) EXPECT_TRUE(std::filesystem::exists(file));
  EXPECT_TRUE(save_comparison_pictures(compare(runs.base, runs.base, {}), folder.path() + "/base",
                                       folder.path() + "/base", folder.path() + "/none")
                  .empty());
  EXPECT_FALSE(std::filesystem::exists(folder.path() + "/none"));
}

}  // namespace
}  // namespace penumbra
