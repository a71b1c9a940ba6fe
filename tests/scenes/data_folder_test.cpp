#include "scenes/data_folder.h"

#include <gmock/gmock.h>

#include <cstdlib>
#include <filesystem>
#include <optional>

#include "tests/support.h"

namespace penumbra {
namespace {

class DataFolder : public testing::Test {
 protected:
  void TearDown() override {
    if (before_) {
      setenv("PENUMBRA_DATA", before_->c_str(), 1);
    } else {
      unsetenv("PENUMBRA_DATA");
    }
  }
  const test::TemporaryFolder folder_;

 private:
  const char* set_ = std::getenv("PENUMBRA_DATA");
  const std::optional<std::string> before_ = set_ ? std::optional<std::string>(set_) : std::nullopt;
};

TEST_F(DataFolder, IsThatOfTheSourcesInABuildInPlace) {
  unsetenv("PENUMBRA_DATA");
  EXPECT_TRUE(std::filesystem::is_directory(data_folder() + "/library"));
  EXPECT_TRUE(std::filesystem::is_directory(data_folder() + "/../results/published"));
}

TEST_F(DataFolder, TheVariableComesFirst) {
  folder_.write("assets.toml", "");
  setenv("PENUMBRA_DATA", folder_.path().c_str(), 1);
  EXPECT_EQ(data_folder(), folder_.path());
}

TEST_F(DataFolder, AVariableThatNamesNoDataIsAMistake) {
  setenv("PENUMBRA_DATA", folder_.path().c_str(), 1);
  EXPECT_THAT(test::error_of([] { data_folder(); }),
              testing::AllOf(testing::StartsWith("PENUMBRA_DATA is '" + folder_.path() + "'"),
                             testing::HasSubstr("share/penumbra/scenes")));
}

}  // namespace
}  // namespace penumbra
