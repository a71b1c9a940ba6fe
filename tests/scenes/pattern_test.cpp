#include "scenes/pattern.h"

#include <gmock/gmock.h>

#include "tests/support.h"

namespace penumbra {
namespace {

TEST(Pattern, IsSearchedAnywhereInAText) {
  const Pattern pattern("row", "b+c$");
  EXPECT_TRUE(pattern.is_in("abbc"));
  EXPECT_FALSE(pattern.is_in("abbcd"));
  EXPECT_TRUE(Pattern("row", "").is_in("anything"));
}

TEST(Pattern, HasTheWholeAndItsPartsOfAWholeText) {
  const Pattern pattern("line", R"((\w+) *= *(\d*))");
  EXPECT_THAT(pattern.parts_of("width = 640"), testing::ElementsAre("width = 640", "width", "640"));
  EXPECT_THAT(pattern.parts_of("width ="), testing::ElementsAre("width =", "width", ""));
  EXPECT_THAT(pattern.parts_of("width = 640 "), testing::IsEmpty());
}

TEST(Pattern, AMistakeNamesWhatItIsOf) {
  const std::string error = test::error_of([] { Pattern("--filter", "("); });
  EXPECT_THAT(error, testing::StartsWith("--filter '(' is not a regular expression: "));
}

}  // namespace
}  // namespace penumbra
