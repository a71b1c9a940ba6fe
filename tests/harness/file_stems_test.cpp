#include "harness/measure/file_stems.h"

#include "scenes/names.h"
#include "tests/support.h"

namespace penumbra {
namespace {

class FileStems : public testing::Test {
 protected:
  Variant variant(const std::string& mode) {
    Variant v{&entry_, {}, 2};
    v.parameters.set("mode", mode);
    return v;
  }
  Entry entry_ = [] {
    Entry e;
    e.name = "t", e.backend = Backend::simd;
    e.parameters = {choice_parameter("mode", {std::string("usual")}, "which")};
    return e;
  }();
};

TEST_F(FileStems, UsualLabelsStayReadable) {
  EXPECT_EQ(file_stems({variant("usual"), variant("x")}),
            (std::map<std::string, std::string>{{"t/simd/threads:2", "t-simd-threads-2"},
                                                {"t/simd/mode:x/threads:2", "t-simd-mode-x-threads-2"}}));
}

TEST_F(FileStems, WhatWouldBeOneFileBecomesTwo) {
  const auto stems = file_stems({variant("a b"), variant("a:b"), variant("A-B"), variant("c")});
  std::set<std::string> keys;
  for (const auto& [label, stem] : stems) keys.insert(file_name_key(stem));
  EXPECT_EQ(keys.size(), 4u);
  EXPECT_EQ(stems.at(variant("c").label()), "t-simd-mode-c-threads-2");
  EXPECT_EQ(stems, file_stems({variant("c"), variant("A-B"), variant("a:b"), variant("a b")})) << "in any order";
}

TEST_F(FileStems, LongLabelsAreCutAndStillDiffer) {
  const std::string shared(300, 'v');
  const auto stems = file_stems({variant(shared + "1"), variant(shared + "2")});
  ASSERT_EQ(stems.size(), 2u);
  EXPECT_NE(stems.begin()->second, stems.rbegin()->second);
  const test::TemporaryFolder folder;
  for (const auto& [label, stem] : stems)
    for (const std::string& file : {stem + ".error.png", stem + ".sheet.png"}) {
      EXPECT_LE(file.size(), 255u);
      EXPECT_TRUE(std::ofstream(folder.path() + "/" + file).good()) << file;
    }
  const std::string fits(255 - 10 - variant("").label().size(), 'v');
  EXPECT_EQ(file_stems({variant(fits)}).begin()->second, file_name(variant(fits).label()));
  EXPECT_NE(file_stems({variant(fits + "v")}).begin()->second, file_name(variant(fits + "v").label()));
}

}  // namespace
}  // namespace penumbra
