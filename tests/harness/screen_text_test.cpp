#include "harness/report/screen_text.h"

#include "tests/harness/screens.h"
#include "tests/support.h"

namespace penumbra {
namespace {

TEST(ScreenText, FiguresHaveThreeDigitsAndNoPowers) {
  EXPECT_EQ(three_digits(0.05712), "0.0571");
  EXPECT_EQ(three_digits(5.701), "5.7");
  EXPECT_EQ(three_digits(1234.4), "1234");
  EXPECT_EQ(three_digits(99.96), "100");
  EXPECT_EQ(three_digits(0.0), "0");
  EXPECT_EQ(with_thousands(16384), "16,384");
  EXPECT_EQ(with_thousands(999), "999");
  EXPECT_EQ(with_thousands(1048576), "1,048,576");
}

TEST(ScreenText, CutsBetweenCodePoints) {
  EXPECT_EQ(columns_of("äöü±"), 4);
  EXPECT_EQ(cut("äöüß", 4), "äöüß");
  EXPECT_EQ(cut("äöüß", 3), "äö…");
  EXPECT_EQ(cut("abc", 0), "");
}

TEST(ScreenText, WrapsAtSpacesAndKeepsPairsTogether) {
  EXPECT_EQ(wrapped("as  it is", 2), "as  it is\n");
  std::string words;
  for (int k = 0; k < 60; ++k) words += (k ? " " : "") + std::string("word") + std::to_string(k);
  const std::string text = wrapped(words, 3, " \\");
  EXPECT_EQ(test::lines_too_long(text, screen_columns), "");
  EXPECT_NE(text.find(" \\\n   word"), std::string::npos) << text;
  std::string joined = text;
  for (std::size_t at; (at = joined.find(" \\\n   ")) != std::string::npos;) joined.replace(at, 6, " ");
  EXPECT_EQ(joined, words + "\n");
  const std::string pair = wrapped(std::string(95, 'a') + " -o\x1fimage.png", 2);
  EXPECT_EQ(pair, std::string(95, 'a') + "\n  -o image.png\n");
}

TEST(ScreenText, TablesDropEmptyColumnsAndAlign) {
  TextTable table({{"name", 20, Align::left}, {"none", 5, Align::right}, {"ms", 6, Align::right}});
  table.row({"a", "", "1.5"});
  table.line("apart:");
  table.row({"longer", "", "12"});
  EXPECT_EQ(table.text(), "  name     ms\n  a       1.5\n  apart:\n  longer   12\n");
}

TEST(ScreenText, TheLastColumnTakesWhatIsLeft) {
  TextTable table({{"a", 60, Align::left}, {"b", 200, Align::left}});
  table.row({std::string(50, 'a'), std::string(150, 'b')});
  EXPECT_EQ(test::lines_too_long(table.text(), screen_columns), "");
  EXPECT_NE(table.text().find("bbb…"), std::string::npos);
}

}  // namespace
}  // namespace penumbra
