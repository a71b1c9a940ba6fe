// penumbra compare, on files and on programs.
#include <nlohmann/json.hpp>

#include "tests/cli/command_line.h"
#include "tests/harness/screens.h"

namespace penumbra {
namespace {

class CompareCommand : public test::CommandLine {
 protected:
  std::string suite() const {
    tiny_scene();
    return folder_.write("suite.toml",
                         "name = \"s\"\nscenes = [\"tiny.toml\"]\ntruth_noise = 0.05\nthreads = 1\n"
                         "[[technique]]\nname = \"pixel-basis\"\nbackend = \"simd\"\n"
                         "[[technique]]\nname = \"pcss\"\nbackend = \"simd\"\n");
  }
  /// A run of the suite into a folder of this name.
  std::string run_into(const std::string& name) const {
    const std::string out = folder_.path() + "/" + name;
    const test::Outcome o = run("run " + suite() + " --repetitions 5 --out " + out);
    EXPECT_EQ(o.code, 0) << o.err;
    return out;
  }
  std::string changed(const std::string& from, const std::string& to, const std::string& find,
                      const std::string& replace) const {
    std::string text = test::read_text(from);
    for (std::size_t at = 0; (at = text.find(find, at)) != std::string::npos; at += replace.size())
      text.replace(at, find.size(), replace);
    return folder_.write(to, text);
  }
};

TEST_F(CompareCommand, ARunWithItselfIsFine) {
  const std::string a = run_into("a");
  const test::Outcome folder = run("compare " + a + " " + a);
  EXPECT_EQ(folder.code, 0) << folder.out << folder.err;
  EXPECT_TRUE(folder.out.starts_with("fine: 1 same, 1 measured in neither")) << folder.out;
  EXPECT_EQ(run("compare " + a + "/results.json " + a).code, 0);
  const test::Outcome json = run("compare " + a + " " + a + " --json");
  EXPECT_EQ(nlohmann::json::parse(json.out)["exit_code"], 0);
  EXPECT_NE(run("compare --markdown " + a + " " + a).out.find("### penumbra: fine"), std::string::npos);
}

TEST_F(CompareCommand, InputThatIsNoneIsSaid) {
  const std::string a = run_into("a"), text = test::read_text(a + "/results.json");
  expect_error("compare " + a, "was given 1");
  expect_error("compare " + a + " " + folder_.path() + "/nowhere", "nowhere");
  expect_error("compare " + a + " " + folder_.write("empty.json", ""), "empty.json");
  expect_error("compare " + a + " " + folder_.write("cut.json", text.substr(0, text.size() / 2)), "cut.json");
  expect_error("compare " + a + " " + folder_.write("foreign.json", "{\"context\": {}, \"benchmarks\": 3}"),
               "foreign.json");
  expect_error("compare " + a + " " + a + " --fail-slower 5", "--fail-slower 5");
  expect_error("compare " + a + " " + a + " --fail-error x%", "--fail-error x%");
  expect_error("compare " + a + " " + a + " --budget 3", "--ab");
  expect_error("compare " + a + " " + changed(a + "/results.json", "other.json", "tiny", "huge"), "no row in common");
}

TEST_F(CompareCommand, ProgramsAreMeasuredSideBySide) {
  const std::string out = folder_.path() + "/ab", program = PENUMBRA_PROGRAM;
  const test::Outcome o =
      run("compare --ab " + program + " " + program + " " + suite() + " --budget 1 --fail-slower 900% --out " + out);
  EXPECT_EQ(o.code, 0) << o.out << o.err;
  EXPECT_EQ(test::lines_too_long(o.out, 100), "");
  for (const char* file : {"/comparison.md", "/comparison.json", "/base/results.json", "/new/results.json"})
    EXPECT_FALSE(test::read_text(out + file).empty()) << file;
  const nlohmann::json found = nlohmann::json::parse(test::read_text(out + "/comparison.json"));
  EXPECT_EQ(found["side_by_side"], true);
  ASSERT_EQ(found["rows"].size(), 1u);
  EXPECT_EQ(found["rows"][0]["error"]["verdict"], "same");
  const test::Outcome again = run("compare " + out + "/base " + out + "/new --fail-slower 900% --json");
  EXPECT_EQ(nlohmann::json::parse(again.out)["rows"], found["rows"]) << "what is on disk says the same";
}

TEST_F(CompareCommand, ProgramsThatAreNoneAreSaid) {
  const std::string program = PENUMBRA_PROGRAM, end = " " + suite() + " --out " + folder_.path() + "/ab";
  expect_error("compare --ab /bin/true " + program + end, "/bin/true");
  expect_error("compare --ab " + program + " /nowhere/program" + end, "/nowhere/program");
  expect_error("compare --ab " + program + " " + program, "was given 2");
  // Runs suites, but cannot be timed row by row.
  const std::string old = folder_.write("old.sh", "#!/bin/sh\n[ $1 = run ] && exec " + program + " \"$@\"\nexit 2\n");
  std::filesystem::permissions(old, std::filesystem::perms::owner_all);
  expect_error("compare --ab " + program + " " + old + end, "older than `compare --ab`");
}

TEST_F(CompareCommand, ARowThatBreaksWhileItIsTimedIsARegression) {
  const std::string program = PENUMBRA_PROGRAM;
  const std::string broken = folder_.write(
      "broken.sh", "#!/bin/sh\n[ $1 = run ] && exec " + program + " \"$@\"\necho '{\"protocol\":1}'\nread q; exit 7\n");
  std::filesystem::permissions(broken, std::filesystem::perms::owner_all);
  const test::Outcome o =
      run("compare --ab " + program + " " + broken + " " + suite() + " --out " + folder_.path() + "/ab");
  EXPECT_EQ(o.code, 1) << o.out << o.err;
  EXPECT_NE(o.out.find("failed now"), std::string::npos) << o.out;
}

}  // namespace
}  // namespace penumbra
