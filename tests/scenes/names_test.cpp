#include "scenes/names.h"

#include "scenes/scene_outline.h"
#include "tests/support.h"

namespace penumbra {
namespace {

std::string scene_text(const std::string& name) {
  return "name = " + name +
         "\n[occluder]\nmesh = \"none\"\n[receivers]\nplane = { half_extent = 1.0, resolution = 4 }\n[light]\n"
         "environment = \"constant\"\n";
}

TEST(Names, WhatLeavesTheFolderIsRefusedWithFileLineAndKey) {
  const test::TemporaryFolder folder;
  for (const char* name : {R"("../../escape")", R"("/tmp/x")", R"("a/b")", R"("a\\b")", R"("")", R"(".")", R"("..")",
                           R"(".hidden")", R"(" a")", R"("a ")", R"("a\u0000b")", R"("a\nb")", R"("a\tb")",
                           R"("a\u007Fb")", R"("a\u0085b")", R"("a|b")"}) {
    const std::string file = folder.write("s.toml", scene_text(name));
    const std::string error = test::error_of([&] { load_scene(file); });
    EXPECT_NE(error.find("s.toml:1: key 'name' is '"), std::string::npos) << name << ": " << error;
    EXPECT_NE(error.find("allowed are 1 to 200 bytes"), std::string::npos) << error;
    for (const char c : error) EXPECT_GE(static_cast<unsigned char>(c), 0x20) << "one line: " << error;
    EXPECT_EQ(test::error_of([&] { read_outline(file); }), error) << "before anything else is loaded";
  }
}

TEST(Names, WithoutOneTheFilesOwnNameCounts) {
  const test::TemporaryFolder folder;
  const std::string text = scene_text("\"x\"").substr(std::string("name = \"x\"\n").size());
  const std::string file = folder.write("my scene.v2.toml", text);
  EXPECT_EQ(load_scene(file).name, "my scene.v2");
  EXPECT_EQ(read_outline(file).name, "my scene.v2");
  const std::string hidden = folder.write(".toml", text), barred = folder.write("a|b.toml", text);
  for (const std::string& bad : {hidden, barred}) {
    const std::string error = test::error_of([&] { load_scene(bad); });
    EXPECT_NE(error.find("key 'name' is missing, and the file's own name is '"), std::string::npos) << error;
    EXPECT_EQ(test::error_of([&] { read_outline(bad); }), error);
  }
}

TEST(Names, OrdinaryTextInAnyScriptIsFine) {
  const test::TemporaryFolder folder;
  for (const std::string name :
       {"bunny-city", "a b:c", "Lügentor", "影", "тень", "a.b", "-x", "truth", "what?", "100%"})
    EXPECT_EQ(load_scene(folder.write("s.toml", scene_text('"' + name + '"'))).name, name);
}

TEST(Names, BytesCountNotLetters) {
  EXPECT_EQ(name_fault(std::string(200, 'n')), "");
  EXPECT_NE(name_fault(std::string(201, 'n')).find("has 201 bytes"), std::string::npos);
  std::string shadows;
  for (int k = 0; k < 67; ++k) shadows += "影";
  const std::string fault = name_fault(shadows);
  EXPECT_NE(fault.find("has 201 bytes"), std::string::npos);
  EXPECT_NE(fault.find("影...'"), std::string::npos) << "cut between letters: " << fault;
}

TEST(Names, KeysAreEqualWhereFilesWouldBe) {
  EXPECT_EQ(file_name("a/b:c d"), "a-b-c-d");
  EXPECT_EQ(file_name_key("A b"), file_name_key("a-B"));
  EXPECT_EQ(file_name_key("Ümlaut ΣΑ"), file_name_key("üMLAUT:σα"));
  EXPECT_NE(file_name_key("a"), file_name_key("b"));
  EXPECT_NE(file_name_key("影"), file_name_key("光"));
  EXPECT_EQ(file_name_key("\xff\xfe"), "\xff\xfe") << "no UTF-8, no letters";
}

}  // namespace
}  // namespace penumbra
