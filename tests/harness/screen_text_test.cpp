#include "harness/report/screen.h"

#include <fmt/format.h>

#include "tests/harness/screens.h"
#include "tests/support.h"

namespace penumbra {
namespace {

TEST(ScreenText, ThousandsHaveCommas) {
  EXPECT_EQ(with_thousands(16384), "16,384");
  EXPECT_EQ(with_thousands(999), "999");
  EXPECT_EQ(with_thousands(1048576), "1,048,576");
}

TEST(ScreenText, CommandsBreakAsAShellReadsThem) {
  std::string words;
  for (int k = 0; k < 60; ++k) words += fmt::format("{}word{}", k ? " " : "", k);
  const std::string text = wrapped_command(words, 60);
  EXPECT_EQ(test::lines_too_long(text, 60), "");
  std::string joined = text;
  for (std::size_t at; (at = joined.find(" \\\n    ")) != std::string::npos;) joined.erase(at + 1, 6);
  EXPECT_EQ(joined, words);
  std::string command(55, 'a'), broken(55, 'a');
  command += " -o\x1fimage.png", broken += " \\\n    -o image.png";
  EXPECT_EQ(wrapped_command(command, 60), broken);
  EXPECT_EQ(wrapped_command("short -o\x1f"
                            "x",
                            60),
            "short -o x");
}

TEST(ScreenText, TablesDropEmptyColumnsAndAlign) {
  TextTable table({{"name", 20, Align::left}, {"none", 5, Align::right}, {"ms", 6, Align::right}}, 80);
  table.row({"a", "", "1.5"});
  table.line("apart:");
  table.row({"longer", "", "12"});
  EXPECT_EQ(table.text(), "  name     ms\n  a       1.5\n  apart:\n  longer   12\n");
}

TEST(ScreenText, TheLastColumnTakesWhatIsLeft) {
  TextTable table({{"a", 60, Align::left}, {"b", 200, Align::left}}, 100);
  table.row({std::string(50, 'a'), std::string(150, 'b')});
  EXPECT_EQ(test::lines_too_long(table.text(), 100), "");
  EXPECT_NE(table.text().find("bbb…"), std::string::npos);
}

}  // namespace
}  // namespace penumbra
