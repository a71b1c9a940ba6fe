// Every command's screens as a terminal of 80 and of 100 columns shows them: no line is longer, no word is cut.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <sys/wait.h>

#include <regex>
#include <sstream>

#include "harness/catalogue/catalogue.h"
#include "harness/commands/describe.h"
#include "harness/report/screen.h"
#include "scenes/assets.h"
#include "tests/support.h"

namespace penumbra {
namespace {

using testing::HasSubstr;

std::vector<std::string> words_of(const std::string& text) {
  std::istringstream in(text);
  return {std::istream_iterator<std::string>(in), {}};
}

/// Columns of the longest line.
std::size_t columns_of(const std::string& text) {
  std::istringstream in(text);
  std::size_t most = 0;
  for (std::string line; std::getline(in, line);)
    most =
        std::max(most, std::size_t(std::count_if(line.begin(), line.end(), [](char c) { return (c & 0xc0) != 0x80; })));
  return most;
}

class Screens : public testing::Test {
 protected:
  struct Outcome {
    int code;
    std::string out, err;
  };
  Screens() {
    folder_.write("tiny.toml",
                  "[occluder]\nmesh = \"box\"\n[receivers]\nplane = { half_extent = 1.0, resolution = 8, y = -1.0 }\n"
                  "[light]\nenvironment = \"constant\"\n");
    folder_.write("suite.toml",
                  "scenes = [\"tiny.toml\"]\n[[technique]]\nname = \"ray-traced\"\nparameters = { rays = [1, 2, 3, 4, "
                  "5, 6, 7, 8, 9, 10] }\n");
    folder_.write("mesh.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    folder_.write("sky.hdr", "");
  }
  /// In the folder, on a terminal of so many columns; 0: none.
  Outcome run(const std::string& arguments, int columns) const {
    const std::string terminal = columns ? fmt::format("COLUMNS={} ", columns) : "env -u COLUMNS ";
    const std::string command = "cd " + folder_.path() + " && PENUMBRA_CACHE=cache " + terminal + PENUMBRA_PROGRAM " " +
                                arguments + " >out.txt 2>err.txt </dev/null";
    const int status = std::system(command.c_str());
    return {WEXITSTATUS(status), test::read_text(folder_.path() + "/out.txt"),
            test::read_text(folder_.path() + "/err.txt")};
  }
  /// Runs at both widths; returns the screen at 100 columns.
  std::string expect_fits(const std::string& arguments, int code = 0) const {
    const Outcome narrow = run(arguments, 80), wide = run(arguments, 100);
    EXPECT_EQ(wide.code, code) << arguments << "\n" << wide.out << wide.err;
    for (const auto& [columns, o] : {std::pair(80u, &narrow), std::pair(100u, &wide)}) {
      EXPECT_LE(columns_of(o->out), columns) << arguments << "\n" << o->out;
      EXPECT_LE(columns_of(o->err), columns) << arguments << "\n" << o->err;
    }
    EXPECT_EQ(words_of(narrow.out), words_of(wide.out)) << arguments << ": a word is cut";
    EXPECT_EQ(words_of(narrow.err), words_of(wide.err)) << arguments << ": a word is cut";
    return wide.out + wide.err;
  }
  test::TemporaryFolder folder_;
};

TEST_F(Screens, OfOrientationFit) {
  const std::string first = expect_fits("");
  EXPECT_EQ(expect_fits("--help"), first);
  EXPECT_EQ(expect_fits("help"), first);
  for (const char* part : {"penumbra run quick", "penumbra init", "minute", "penumbra list NAME", "--version"})
    EXPECT_THAT(first, HasSubstr(part));
  EXPECT_LE(std::count(first.begin(), first.end(), '\n'), 30);
  EXPECT_EQ(run("list", 300).out, run("list", 100).out) << "wide terminals are not filled";
  const std::string version = expect_fits("--version");
  for (const char* part : {"commit", "compiler", "instruction sets", "cuda"}) EXPECT_THAT(version, HasSubstr(part));
  EXPECT_TRUE(std::regex_search(version, std::regex("^penumbra [0-9]+\\.[0-9]+"))) << version;
}

TEST_F(Screens, OfEveryCommandsHelpFit) {
  const std::string first = run("", 100).out;
  const std::string list = first.substr(first.find("\ncommands\n") + 10);
  int commands = 0;
  std::istringstream lines(list);
  for (std::string line; std::getline(lines, line) && !line.empty();) {
    if (!std::regex_search(line, std::regex("^  [a-z]"))) continue;
    const std::string command = words_of(line).at(0);
    const std::string help = expect_fits(command + " --help");
    EXPECT_THAT(help, HasSubstr("usage: penumbra " + command));
    EXPECT_EQ(expect_fits("help " + command), help);
    ++commands;
  }
  EXPECT_GE(commands, 7);
  const std::string run_help = run("run --help", 100).out;
  for (const char* part : {"default: results/runs/latest", "(required)", "--dry-run"})
    EXPECT_THAT(run_help, HasSubstr(part));
}

TEST_F(Screens, OfListsAndFormatsFit) {
  const std::string list = expect_fits("list");
  EXPECT_THAT(list, HasSubstr("\ncuda: ")) << "scripts look for this line";
  for (const char* arguments :
       {"list resting-sphere-constant", "list two-blockers", "list quick", "list spheres", "list tiny.toml",
        "list suite.toml", "help scene", "help suite", "help technique ray-traced"})
    expect_fits(arguments);
  const std::string dry = expect_fits("run suite.toml --dry-run");
  EXPECT_THAT(dry, HasSubstr("20 rows on 1 scene"));
  for (const int columns : {80, 100}) {
    const std::string text = run(fmt::format("init fresh-{}", columns), columns).out;
    EXPECT_LE(columns_of(text), std::size_t(columns)) << text;
    EXPECT_THAT(text, HasSubstr(fmt::format("  penumbra run fresh-{0}/suite.toml --out fresh-{0}/results", columns)));
  }
}

TEST_F(Screens, OfEveryTechniqueSceneAndSuiteFit) {
  const Registry registry = make_registry();
  const auto expect_text_fits = [](const auto& describe) {
    for (const int width : {80, 100}) {
      const std::string text = describe(width);
      EXPECT_LE(columns_of(text), std::size_t(width)) << text;
      EXPECT_EQ(words_of(text), words_of(describe(100000)));
    }
  };
  for (const std::string& name : technique_names(registry)) {
    expect_text_fits([&](int width) { return describe_technique(name, registry, width); });
    EXPECT_THAT(describe_technique(name, registry, 100), HasSubstr("penumbra render"))
        << "no shipped suite measures it";
  }
  for (const std::string& name : shipped_names("suites"))
    expect_text_fits([&](int width) { return describe_suite(name, registry, width); });
}

TEST_F(Screens, OfMistakesFitAndLeadOn) {
  const auto expect_leads = [&](const std::string& arguments, const std::vector<std::string>& parts) {
    const std::string screen = expect_fits(arguments, 2);
    EXPECT_TRUE(screen.starts_with("penumbra: ")) << screen;
    const std::string line = run(arguments, 0).err;
    EXPECT_EQ(line.find('\n'), line.size() - 1) << "one line where there is no terminal: " << line;
    for (const std::string& part : parts) EXPECT_THAT(line, HasSubstr(part)) << arguments;
  };
  expect_leads("rn", {"'rn' is no command", "did you mean `penumbra run`"});
  expect_leads("dance", {"'dance' is no command; there are: ", "render"});
  expect_leads("mesh.obj", {"no command but a mesh", "penumbra choose mesh.obj --error 2%"});
  expect_leads("bunny-city", {"no command but a scene"});
  expect_leads("run mesh.obj",
               {"no suite but a mesh", "penumbra choose mesh.obj --error 2%", "--mesh mesh.obj", "minute"});
  expect_leads("run bunny-city", {"no suite but a scene", "penumbra run quick --scene bunny-city", "penumbra choose"});
  expect_leads("run tiny.toml", {"no suite but a scene", "--scene tiny.toml"});
  expect_leads("run ray-traced", {"no suite but a technique", "penumbra list ray-traced"});
  expect_leads("run sky.hdr", {"no suite but a light", "penumbra choose MESH --light sky.hdr"});
  expect_leads("run quik", {"'quik' is neither", "did you mean 'quick'?"});
  expect_leads("run quick --scene mesh.obj", {"no scene but a mesh"});
  expect_leads("render mesh.obj --technique ray-traced -o a.png", {"no scene but a mesh", "penumbra choose"});
  expect_leads("render suite.toml --technique ray-traced -o a.png",
               {"no scene but a suite", "penumbra run suite.toml"});
  expect_leads("reference bunny -o a.png", {"no scene but a mesh"});
  expect_leads("render tiny.toml --technique ray-trace -o a.png", {"did you mean 'ray-traced'?"});
  expect_leads("run quick --fliter x", {"run: ", "--fliter", "did you mean '--filter'?", "penumbra run --help"});
  expect_leads("run", {"run: suite is required"});
  expect_leads("run quick --repetitions 0", {"run: --repetitions", "1000"});
  expect_leads("list pixel-basi", {"did you mean 'pixel-basis'?"});
  expect_leads("list mesh.obj", {"but a mesh"});
  expect_leads("help technique", {"which one"});
  expect_leads("help technique magic", {"unknown technique 'magic'"});
  expect_leads("help scnee", {"did you mean 'scene'?"});
}

TEST(Wrapping, BreaksAtSpacesAndHangs) {
  EXPECT_EQ(wrapped("one two three", 7), "one two\nthree");
  EXPECT_EQ(wrapped("one two three", 8, 2), "one two\n  three");
  EXPECT_EQ(wrapped("one two three", 6, 2), "one\n  two\n  three");
  EXPECT_EQ(wrapped("one two", 9, 0, 3), "one\ntwo") << "it begins in the fourth column";
  EXPECT_EQ(wrapped("one two", 10, 0, 3), "one two");
  EXPECT_EQ(wrapped("\u00e9\u00e9 \u00e9\u00e9", 5), "\u00e9\u00e9 \u00e9\u00e9") << "letters, not bytes";
  EXPECT_EQ(wrapped("a-word-that-is-long b", 5), "a-word-that-is-long\nb") << "words stay whole";
  EXPECT_EQ(wrapped("one\ntwo", 80, 1), "one\n two");
  EXPECT_EQ(labelled("a", "one two", 5, 9), "  a  one\n     two\n");
  EXPECT_EQ(labelled("abcd", "x", 6, 20), "  abcd\n      x\n") << "text never touches its label";
  EXPECT_EQ(labelled("long-label", "one", 5, 20), "  long-label\n     one\n");
  EXPECT_EQ(labelled("abc", "", 5, 20), "  abc\n");
}

}  // namespace
}  // namespace penumbra
