#include "scenes/nearest_name.h"

#include "tests/support.h"

namespace penumbra {
namespace {

TEST(NearestName, FindsWhatOneOrTwoMistakesMakeOfIt) {
  const std::vector<std::string> names = {"run", "render", "reference", "fit"};
  for (const char* word : {"rn", "rnu", "runn", "rum"}) EXPECT_EQ(nearest_name(word, names), "run") << word;
  for (const char* word : {"redner", "rander", "rendr", "renderer"})
    EXPECT_EQ(nearest_name(word, names), "render") << word;
  EXPECT_EQ(nearest_name("refrenc", names), "reference") << "two letters left out";
  EXPECT_EQ(nearest_name("refrnc", names), "") << "three";
  EXPECT_EQ(nearest_name("rx", names), "") << "short words: one mistake alone";
  EXPECT_EQ(nearest_name("f", names), "") << "as many mistakes as letters";
  EXPECT_EQ(nearest_name("", names), "");
  EXPECT_EQ(nearest_name(std::string(100000, 'r'), names), "") << "in no time";
}

TEST(NearestName, TheNearestWinsAndOfEquallyNearOnesTheFirst) {
  EXPECT_EQ(nearest_name("bunny-lamp-larg", {"bunny-lamp-small", "bunny-lamp-large"}), "bunny-lamp-large");
  EXPECT_EQ(nearest_name("bat", {"cat", "hat"}), "cat");
  EXPECT_EQ(did_you_mean("bat", {"cat"}), "; did you mean 'cat'?");
  EXPECT_EQ(did_you_mean("xyz", {"cat"}), "");
}

}  // namespace
}  // namespace penumbra
