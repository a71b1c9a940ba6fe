#include "harness/results/text.h"

#include <gtest/gtest.h>

namespace penumbra {
namespace {

TEST(Text, ColumnsAreLettersAndWideOnesAreTwo) {
  EXPECT_EQ(columns_of("truth"), 5);
  EXPECT_EQ(columns_of("± 3 % …"), 7);
  EXPECT_EQ(columns_of("häschen"), 7);
  EXPECT_EQ(columns_of("兔子"), 4);
  EXPECT_EQ(columns_of("🐇"), 2);
  EXPECT_EQ(columns_of("\xff\xfe"), 2) << "no UTF-8";
  EXPECT_EQ(columns_of("\xe5\x85"), 2) << "half a letter";
}

TEST(Text, IsCutBetweenLetters) {
  EXPECT_EQ(cut_to_columns("truth", 5), "truth");
  EXPECT_EQ(cut_to_columns("truths", 5), "trut…");
  EXPECT_EQ(cut_to_columns("häschen", 3), "hä…");
  EXPECT_EQ(cut_to_columns("兔子兔子", 6), "兔子…");
  EXPECT_EQ(cut_to_columns("兔子兔子", 4), "兔…");
  EXPECT_EQ(cut_to_columns("abc", 1), "…");
  EXPECT_EQ(cut_to_columns("abc", 0), "");
  for (int columns = 0; columns < 12; ++columns)
    EXPECT_LE(columns_of(cut_to_columns("ä兔b🐇± \xff…z", columns)), columns);
}

TEST(Text, LosesWholeLetters) {
  EXPECT_EQ(without_last_letter("hä"), "h");
  EXPECT_EQ(without_last_letter("兔子"), "兔");
  EXPECT_EQ(without_last_letter("a"), "");
  EXPECT_EQ(without_last_letter(""), "");
  EXPECT_EQ(first_letter("兔子"), "兔");
  EXPECT_EQ(first_letter("\xffz"), "\xff");
  EXPECT_EQ(first_letter(""), "");
}

TEST(Text, DurationsAreRoundedUp) {
  EXPECT_EQ(duration_text(0.0), "1 s");
  EXPECT_EQ(duration_text(44.2), "45 s");
  EXPECT_EQ(duration_text(99.0), "99 s");
  EXPECT_EQ(duration_text(184.5), "3 min 05 s");
  EXPECT_EQ(duration_text(3600.0), "1 h 00 min");
  EXPECT_EQ(duration_text(7500.0), "2 h 05 min");
}

}  // namespace
}  // namespace penumbra
